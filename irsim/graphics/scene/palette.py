"""Colours of everything drawn, one name each; the colours themselves are those of :mod:`irsim.options.colors`."""

from __future__ import annotations

from dataclasses import dataclass, field

from irsim.options.colors import ACKER_COLOR, CYCLE, OBSTACLE_COLOR, PUSHABLE_COLOR, ROBOT_COLOR

__all__ = ["Color", "Palette"]

Color = str | tuple[float, ...]
"""Anything Matplotlib reads as a colour: a name, ``#rrggbb``, a grey level, or an RGB(A) tuple of 0..1."""

_SKY, _BLUE, _PINK, _YELLOW, _RED = "#56B4E9", "#0072B2", "#CC79A7", "#F0E442", "#CC3311"
"""Okabe and Ito: Color Universal Design (2008); the red is of Paul Tol's vibrant scheme."""


@dataclass
class Palette:
    """One colour per kind of drawing; scenario and code override them.

    Attributes:
        robot: Robots of every drive but ``acker``.
        robot_acker: Car-like robots.
        obstacle: Obstacles and maps.
        pushable: Objects without a drive that contact may push.
        arrow: Heading arrows.
        fov, fov_edge: View sector and its outline.
        lidar: Beams.
        laser_highlight: Beams picked out by ``set_laser_color``.
        fmcw_zero_velocity, fmcw_positive_velocity, fmcw_negative_velocity: Doppler beams: still, receding, approaching.
        marker: ``draw_points``.
        path: ``draw_trajectory`` and ``draw_box``.
        quiver: ``draw_quiver``.
        cycle: Handed out in turn by ``color: cycle``.
    """

    robot: str = ROBOT_COLOR
    robot_acker: str = ACKER_COLOR
    obstacle: str = OBSTACLE_COLOR
    pushable: str = PUSHABLE_COLOR
    arrow: str = _YELLOW
    fov: str = _SKY
    fov_edge: str = _BLUE
    lidar: str = _RED
    laser_highlight: str = _SKY
    fmcw_zero_velocity: str = _SKY
    fmcw_positive_velocity: str = _RED
    fmcw_negative_velocity: str = _BLUE
    marker: str = _PINK
    path: str = _BLUE
    quiver: str = "k"
    cycle: list[str] = field(default_factory=lambda: list(CYCLE))

    def cycle_color(self, index: int) -> str:
        """Colour of the ``index``-th object of a group drawn with ``color: cycle``."""
        return self.cycle[index % len(self.cycle)]
