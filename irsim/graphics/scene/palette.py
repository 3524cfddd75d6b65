"""The palette: a colour for each kind of drawing; those of objects come from :mod:`irsim.options.colors`."""

from __future__ import annotations

from dataclasses import dataclass, field

from irsim.options.colors import ACKER_COLOR, CYCLE, OBSTACLE_COLOR, PUSHABLE_COLOR, ROBOT_COLOR

__all__ = ["Color", "Palette"]

Color = str | tuple[float, ...]
"""A colour that Matplotlib accepts: a name, ``#rrggbb``, a grey level, or an RGB(A) tuple of 0..1."""

# Okabe and Ito: Color Universal Design (2008); the red comes from Paul Tol's vibrant scheme.
_SKY = "#56B4E9"
_BLUE = "#0072B2"
_PINK = "#CC79A7"
_YELLOW = "#F0E442"
_RED = "#CC3311"
_PURPLE = "#882255"  # of Tol's muted scheme


@dataclass
class Palette:
    """One colour per kind of drawing; a scenario or a script can override them.

    Attributes:
        robot: Robots with any drive except ``acker``.
        robot_acker: Car-like robots.
        obstacle: Obstacles and maps.
        pushable: Objects without a drive that contact may push.
        arrow: Heading arrows.
        fov, fov_edge: View sector and its outline.
        lidar: Beams.
        laser_highlight: Beams picked out by ``set_laser_color``.
        fmcw_zero_velocity, fmcw_positive_velocity, fmcw_negative_velocity: Doppler beams whose target keeps its
            distance, recedes, approaches.
        zone: Lines and areas of `world.zones`.
        contact: Contacts within a step.
        marker: Points of ``draw_points``.
        path: Lines of ``draw_trajectory`` and ``draw_box``.
        quiver: Arrows of ``draw_quiver``.
        cycle: Colours that ``color: cycle`` assigns in turn.
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
    zone: str = _PURPLE
    contact: str = _RED
    marker: str = _PINK
    path: str = _BLUE
    quiver: str = "k"
    cycle: list[str] = field(default_factory=lambda: list(CYCLE))

    def cycle_color(self, index: int) -> str:
        """Return the colour of the object with this index in a group drawn with ``color: cycle``."""
        return self.cycle[index % len(self.cycle)]
