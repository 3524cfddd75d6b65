"""The colour of an object in a picture, and the direction of its dart: one rule for pictures and for pages."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from irsim.options.colors import ACKER_COLOR, CYCLE, ROBOT_COLOR

if TYPE_CHECKING:
    from irsim.objects.view import ObjectView
    from irsim.scenario.resolve.resolved import ObjectRecord

__all__ = ["distinct_colors", "shows_motion"]

_DISTINCT = 6
"""Number of colours that all people can tell apart."""


def distinct_colors(objects: Sequence[ObjectView]) -> dict[int, Any]:
    """The colour of each object of a world by its id; two to six robots whose colours were not chosen get one each.

    Args:
        objects: All objects of the world, also later and earlier ones, so that no colour changes in a run.
    """
    colors = {view.id: _own_color(view) for view in objects}
    robots = [view for view in objects if view.role == "robot"]
    same = [view for view in robots if colors[view.id] in (ROBOT_COLOR, ACKER_COLOR)]
    others = {str(colors[view.id]) for view in robots} - {ROBOT_COLOR, ACKER_COLOR}
    free = [color for color in CYCLE[:_DISTINCT] if color not in others]
    if 1 < len(same) <= len(free):
        colors.update(zip((view.id for view in same), free, strict=False))
    return colors


def _own_color(view: ObjectView) -> Any:
    chosen = view.record.plot.obj_color
    color = view.color if chosen is None else chosen
    return color if color != "none" else "k"


def shows_motion(record: ObjectRecord) -> bool:
    """Whether the dart of an object points where it moves, because its drive never turns it; else it is its heading."""
    return not getattr(record.kinematics, "turns", True)
