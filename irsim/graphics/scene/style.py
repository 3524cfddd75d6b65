"""The style of one object: its `plot` keys, defaults that depend on the object, and the overrides of a frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

from irsim.options.colors import ACKER_COLOR, CYCLE, OBSTACLE_COLOR, PUSHABLE_COLOR, ROBOT_COLOR

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ObjectRecord

__all__ = [
    "STYLE_KEYS",
    "TEXT_GAP_M",
    "Color",
    "ObjectStyle",
    "Palette",
    "default_text_position",
    "resolve_style",
    "tint_of",
]

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


@dataclass(slots=True)
class ObjectStyle:
    """The plot keys of the scenario language (:class:`irsim.scenario.model.plot.ObjectPlot`), all with a value.

    Lengths are in metres, line widths and text sizes in points.
    """

    obj_color: Color
    obj_alpha: float
    obj_linestyle: str
    obj_linewidth: float
    obj_zorder: float
    image_zorder: float
    show_goal: bool
    goal_color: Color
    goal_alpha: float
    goal_zorder: float
    show_goal_text: bool
    show_goals: bool
    show_text: bool
    text_color: Color
    text_size: float
    text_alpha: float
    text_zorder: float
    text_position: tuple[float, float]
    show_arrow: bool
    arrow_color: Color
    arrow_length: float
    arrow_width: float
    arrow_alpha: float
    arrow_zorder: float
    show_trajectory: bool
    traj_color: Color
    traj_style: str
    traj_width: float
    traj_alpha: float
    traj_zorder: float
    keep_traj_length: int
    show_trail: bool
    trail_freq: int
    trail_type: str
    trail_edgecolor: Color
    trail_linewidth: float
    trail_alpha: float
    trail_fill: bool
    trail_color: Color
    trail_zorder: float
    keep_trail_length: int
    show_sensor: bool
    show_fov: bool
    fov_color: Color
    fov_edge_color: Color
    fov_alpha: float
    fov_zorder: float


STYLE_KEYS = frozenset(entry.name for entry in fields(ObjectStyle)) - {"image_zorder"}
"""Keys that the section `plot` of an object and ``env.render(...)`` accept."""

TEXT_GAP_M = 0.1
"""Default distance between a label and the bounding circle of its object [m]."""


def resolve_style(
    record: ObjectRecord,
    *,
    color: Color,
    shape: str,
    radius: float,
    width: float,
    palette: Palette,
    overrides: Mapping[str, Any],
) -> ObjectStyle:
    """Return the style of one object.

    Args:
        record: The object.
        color: Colour of the object.
        shape: ``circle``, ``polygon``, ``linestring`` or ``compound``.
        radius: Radius of the bounding circle [m].
        width: Extent along body y [m], the default width of the trajectory.
        palette: Default colours of arrows and view sectors.
        overrides: Keys given for this frame, which take precedence. A value of None counts as not given.
    """
    plot = record.plot
    values: dict[str, Any] = {key: value for key, value in plot.__dict__.items() if key in STYLE_KEYS}
    for key, default in (
        ("arrow_color", palette.arrow),
        ("fov_color", palette.fov),
        ("fov_edge_color", palette.fov_edge),
    ):
        if key not in plot.model_fields_set:
            values[key] = default
    values.update((key, value) for key, value in overrides.items() if key in STYLE_KEYS and value is not None)
    defaults = {
        "obj_color": color,
        "goal_color": color,
        "traj_color": color,
        "trail_color": color,
        "trail_edgecolor": color,
        "traj_width": width,
        "text_position": default_text_position(radius),
        "trail_type": shape,
        "show_arrow": getattr(record.kinematics, "arrow", False) and not record.static,
        "image_zorder": 2.0 if values["obj_zorder"] is None else values["obj_zorder"],
        "obj_zorder": 3.0 if record.role == "robot" else 1.0,
    }
    values.update((key, value) for key, value in defaults.items() if values.get(key) is None)
    return ObjectStyle(**values)


def default_text_position(radius: float) -> tuple[float, float]:
    """Return where the name of an object of this radius [m] starts, relative to its pose."""
    return -radius - TEXT_GAP_M, radius + TEXT_GAP_M


def tint_of(record: ObjectRecord, image: str, color: Color) -> Color | None:
    """Return the hue in which the image of an object is drawn, or None to leave the image as it is.

    Only the default image of a drive is tinted, and only if the object has another colour than its default.
    """
    drive = record.kinematics
    if drive is None or image != getattr(drive, "picture", None) or color == "none":
        return None
    usual = getattr(drive, "usual_colors", None) or (ACKER_COLOR, OBSTACLE_COLOR)
    return None if color == usual[record.role == "obstacle"] else color
