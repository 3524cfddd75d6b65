"""``follow``: plan a path on the map, follow it with a local behavior."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import BehaviorOptions
from irsim.options.knowledge import Fact
from irsim.options.regions import Region
from irsim.options.registry import BEHAVIORS, PLANNERS
from irsim.options.selection import Select
from irsim.options.units import Meters, Seconds


class Follow(BehaviorOptions):
    """Plan a path round everything static, out of dead ends and through mazes, and follow it.

    The planner knows the whole map, and keeps the path clear of everything static that is not `unobstructed`. Commands
    after which the object could not stop (`acce`) before something static are slowed down, and it brakes for its last
    goal. Without a path it stays, and a `no_path` event reports it.

    The local behavior avoids moving objects (`dash` avoids none; `orca` is the usual choice, also for cars). Towards
    static objects it keeps only the clearance that the path has, without its own margins, horizons and forces, which
    would close narrow passages. With `arrive_mode: state` a car plans poses to the heading of its goal, backing up
    where that helps. Where there is no space to turn, `diff` and `acker` follow poses, and wait for objects in the way.

    A robot that has arrived or was stopped for good on the path is gone round: under `dash` at once, else when there
    is no progress. Where there is no way round, a `no_path` event names it.

    Unless the local behavior is `dash`, an object on a route stays on its own side of a line between it and each object
    near it. Others on routes do the same, so they never touch. If two hold each other up for a second, the one with the
    shorter way left goes first. Cars that block each other plan a path round each other, or back up the way they came
    (`vel_min` below 0).
    """

    avoids: ClassVar[bool] = True
    knows: ClassVar[frozenset[Fact]] = frozenset({"map", "arrivals"})
    follows_paths: ClassVar[bool] = False

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [
            {"name": "follow", "planner": "astar", "local": "dash"},
            {"name": "follow", "within": {"rectangle": [0, 4, 20, 6]}},
            {"name": "follow", "avoid": ["people_talking"]},
        ]
    }
    also_called: ClassVar[dict[str, str]] = {
        "region": "within",
        "area": "within",
        "inside": "within",
        "bounds": "within",
        "corridor": "within",
        "avoid_zones": "avoid",
        "keep_out": "avoid",
        "keep_clear": "avoid",
        "forbidden": "avoid",
        "no_go": "avoid",
        "exclude": "avoid",
        "zones": "avoid",
    }

    name: Literal["follow"] = "follow"
    planner: Annotated[Any, Select(PLANNERS, short=(None, "name")), Field(validate_default=True)] = "astar"
    """Path planner, with or without options."""
    local: Annotated[
        Any, Select(BEHAVIORS, accepts="follows_paths", short=(None, "name")), Field(validate_default=True)
    ] = "dash"
    """Behavior that drives from corner to corner, as in `local: {name: orca, timeHorizon: 2}`."""
    replan: Annotated[Seconds, Field(gt=0)] | None = None
    """Plan again after this time; null plans once per goal, and when the path is lost."""
    lookahead: Annotated[Meters, Field(gt=0)] | None = None
    """Distance along the path to the point that the object heads for; null is the farthest corner in sight."""
    within: Region | None = None
    """Area that the path stays in, so that it does not go round through the open ends of a corridor or outside a
    building. It holds for the middle of the object; one that is pushed out comes back."""
    avoid: list[Annotated[str, Field(strict=True, min_length=1)]] = []
    """Names of zones of `world.zones` that are solid for this object alone: its body does not enter them, not even to
    give way. One that starts in a zone or is pushed into it leaves it."""

    def known(self) -> frozenset[Fact]:
        """The map, who has parked, and what its local behavior knows; with one that avoids, outlines, too."""
        if not isinstance(self.local, BehaviorOptions) or not self.local.avoids:
            return self.knows
        return self.knows | self.local.known() | {"circles", "outlines"}

    def draws(self) -> bool:
        """Whether its local behavior draws random numbers."""
        return isinstance(self.local, BehaviorOptions) and self.local.draws()


BEHAVIORS.register(Follow, kernel=core.RouteOptions)
