"""``rvo``: reciprocal velocity obstacles."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import BehaviorOptions
from irsim.options.knowledge import Fact
from irsim.options.registry import BEHAVIORS
from irsim.options.units import Degrees, Meters, MetersPerSecond, Number


class Rvo(BehaviorOptions):
    """Pick the velocity closest to the desired one outside all reciprocal velocity obstacles.

    A wall that stands free is passed on the nearer side; a wall round the object blocks what reaches it within 1 s.
    Boxes that touch are walls of their own; a `compound` is one.
    Avoiding nothing, it turns at most at 1.5 rad/s. With `acce` it brakes in time. It stays in dead ends.
    """

    avoids: ClassVar[bool] = True
    knows: ClassVar[frozenset[Fact]] = frozenset({"circles", "static"})

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "rvo", "vxmax": 1.5, "vymax": 1.5, "acce": 1.0, "factor": 1.0}]
    }

    name: Literal["rvo"] = "rvo"
    vxmax: Annotated[MetersPerSecond, Field(gt=0)] = 1.5
    """Largest speed along world x that is considered."""
    vymax: Annotated[MetersPerSecond, Field(gt=0)] = 1.5
    """The same along world y."""
    acce: Annotated[MetersPerSecond, Field(gt=0)] = 1.0
    """Largest change of velocity in one step: half the width of the search window, not multiplied by the period."""
    factor: Annotated[Number, Field(ge=0)] = 1.0
    """Weight of the time to collision when every velocity leads to a collision."""
    mode: Literal["rvo", "hrvo", "vo"] = "rvo"
    """Share of the avoidance taken: half (`rvo`), all (`vo`), or half on one side and all on the other (`hrvo`)."""
    neighbor_threshold: Annotated[Meters, Field(gt=0)] = 3.0
    """Objects and walls farther away are ignored."""
    sidestep: Annotated[Degrees, Field(ge=-45, le=45)] | None = None
    """As in `orca`: null breaks ties only, 0 is the law of IR-SIM."""
    turning: Literal["limit", "fixed"] = "limit"
    """While it avoids something, a drive turns as fast as `vel_max` allows (`limit`) or as in IR-SIM (`fixed`)."""
    keep_gap: bool | None = None
    """Take at most 2/5 of a gap to a circle in a step; null: robots do, others do not."""

    def top_speed_of_its_own(self) -> float:
        """Limit of speed among its own keys [m/s]."""
        return math.hypot(self.vxmax, self.vymax)


BEHAVIORS.register(Rvo, kernel=core.RvoOptions)
