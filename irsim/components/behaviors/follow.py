"""``follow``: plan a path on the map, follow it with a local behavior."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.behaviors._options import BehaviorOptions
from irsim.options.registry import BEHAVIORS, PLANNERS
from irsim.options.selection import Select
from irsim.options.units import Meters, Seconds


class Follow(BehaviorOptions):
    """Find a way round everything that stands still, out of dead ends and through mazes, and drive it.

    The planner knows the whole map from the start. The path keeps clear of everything that stands still and is not
    `unobstructed`: obstacles, cells of the map, walls round the world. It is planned once per goal, and anew when the
    object has been pushed off it. Commands that would run into something that stands still are slowed down. Without a
    path the object stands still, and a `no_path` event says so.

    The local behavior avoids who moves (`dash` nobody; `orca` is the usual choice, also for cars). From what stands
    still it only keeps the room its path needs, without the margins, horizons and forces it has on its own, which would
    close narrow ways. Where there is no room to turn, `diff` and `acker` drive a way of poses instead, with the turning
    circle of a car, and wait for who is in the way.
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "follow", "planner": "astar", "local": "dash"}]}

    name: Literal["follow"] = "follow"
    planner: Annotated[Any, Select(PLANNERS, short=(None, "name")), Field(validate_default=True)] = "astar"
    """Path planner: its name, or a mapping with its name and options."""
    local: Annotated[
        Any, Select(BEHAVIORS, exclude=("follow",), short=(None, "name")), Field(validate_default=True)
    ] = "dash"
    """Behavior that drives from one corner to the next: its name, or a mapping with its name and options, as in
    `local: {name: orca}`."""
    replan: Annotated[Seconds, Field(gt=0)] | None = None
    """Plan anew after this time; null plans once per goal, and when the path is lost."""
    lookahead: Annotated[Meters, Field(gt=0)] | None = None
    """Distance along the path of the point headed for; null is the farthest corner in sight."""


BEHAVIORS.register(Follow, kernel=core.RouteOptions)
