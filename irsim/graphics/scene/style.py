"""How one object is drawn: its `plot` keys, what the object itself decides, and the overrides of a frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

from irsim.graphics.scene.palette import Color, Palette
from irsim.options.colors import ACKER_COLOR, OBSTACLE_COLOR

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ObjectRecord

__all__ = ["STYLE_KEYS", "ObjectStyle", "resolve_style", "tint_of"]


@dataclass(slots=True)
class ObjectStyle:
    """The plot keys of the scenario language (:class:`irsim.scenario.model.plot.ObjectPlot`), nothing left open.

    Lengths are metres; line widths and text sizes are points.
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
"""The keys that a scenario's `plot` and ``env.render(...)`` understand."""

_TEXT_GAP = 0.1


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
    """The style of one object.

    Args:
        record: The object.
        color: Its colour.
        shape: ``circle``, ``polygon``, ``linestring`` or ``compound``.
        radius: Radius of the bounding circle [m].
        width: Extent along body y [m], the default width of the trajectory.
        palette: Colours of arrows and view sectors, where the scenario chose none.
        overrides: Keys given for this frame; they win. None stands for "not given".
    """
    plot = record.plot
    values: dict[str, Any] = {key: value for key, value in plot.__dict__.items() if key in STYLE_KEYS}
    for key, standard in (
        ("arrow_color", palette.arrow),
        ("fov_color", palette.fov),
        ("fov_edge_color", palette.fov_edge),
    ):
        if key not in plot.model_fields_set:
            values[key] = standard
    values.update((key, value) for key, value in overrides.items() if key in STYLE_KEYS and value is not None)
    own = {
        "obj_color": color,
        "goal_color": color,
        "traj_color": color,
        "trail_color": color,
        "trail_edgecolor": color,
        "traj_width": width,
        "text_position": (-radius - _TEXT_GAP, radius + _TEXT_GAP),
        "trail_type": shape,
        "show_arrow": getattr(record.kinematics, "arrow", False) and not record.static,
        "image_zorder": 2.0 if values["obj_zorder"] is None else values["obj_zorder"],
        "obj_zorder": 3.0 if record.role == "robot" else 1.0,
    }
    values.update((key, value) for key, value in own.items() if values.get(key) is None)
    return ObjectStyle(**values)


def tint_of(record: ObjectRecord, image: str, color: Color) -> Color | None:
    """The colour that the image of a drive takes on: that of the object, if somebody chose one.

    An image that the scenario names is drawn as it is.
    """
    drive = record.kinematics
    if drive is None or image != getattr(drive, "picture", None) or color == "none":
        return None
    usual = getattr(drive, "usual_colors", None) or (ACKER_COLOR, OBSTACLE_COLOR)
    return None if color == usual[record.role == "obstacle"] else color
