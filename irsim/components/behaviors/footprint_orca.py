"""``footprint_orca``: reciprocal collision avoidance with the true outlines of bodies."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import BehaviorOptions
from irsim.options.knowledge import Fact
from irsim.options.registry import BEHAVIORS
from irsim.options.units import Bool, Count, Meters, MetersPerSecond, Seconds


class FootprintOrca(BehaviorOptions):
    """Avoid others by their true outlines instead of circles: for dense crowds of robots.

    Robots that all run it touch neither each other nor what stands, if drives are exact: within `acce` each can always
    stop where no other may be. It plans a way round what stands, at most 4 m aside; without progress it tries random
    directions. Arrived robots make room and come back. Around larger walls use it as the `local` of `follow`.
    """

    in_group: ClassVar[bool] = True
    avoids: ClassVar[bool] = True
    knows: ClassVar[frozenset[Fact]] = frozenset({"circles", "outlines", "arrivals", "laws", "static"})
    stops_in_time: ClassVar[bool] = True

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "footprint_orca"}]}

    name: Literal["footprint_orca"] = "footprint_orca"
    neighborDist: Annotated[Meters, Field(gt=0)] = 5.0
    """Moving objects farther away are ignored."""
    maxNeighbors: Count = 8
    """Number of moving objects that choose its velocity, nearest first; it touches none of the others."""
    timeHorizon: Annotated[Seconds, Field(gt=0)] = 1.5
    """Time horizon for moving objects; doubled if they run another behavior."""
    timeHorizonObst: Annotated[Seconds, Field(gt=0)] = 0.5
    """Time horizon for walls and all that has stopped; it brakes in time with any."""
    safe_distance: Annotated[Meters, Field(ge=0)] = 0.02
    """Distance kept where there is room; 0.1 m more from movers of other behaviors."""
    maxSpeed: Annotated[MetersPerSecond, Field(gt=0)] | None = None
    """Largest speed."""
    backward: Bool = True
    """Whether drives that cannot move sideways also drive backward, if `vel_min` allows it."""

    def draws(self) -> bool:
        """True: the directions that it tries without progress are random."""
        return True


BEHAVIORS.register(FootprintOrca, kernel=core.FootprintOrcaOptions)
