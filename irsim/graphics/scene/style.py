"""The style of one object: its `plot` keys, defaults that depend on the object, and the overrides of a frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

from irsim.graphics.scene.palette import Color, Palette
from irsim.options.colors import ACKER_COLOR, OBSTACLE_COLOR

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ObjectRecord

__all__ = ["STYLE_KEYS", "TEXT_GAP_M", "ObjectStyle", "default_text_position", "resolve_style", "tint_of"]


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
