"""``footprint_orca``: reciprocal collision avoidance with the true outlines of bodies."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.behaviors._options import BehaviorOptions
from irsim.options.registry import BEHAVIORS
from irsim.options.units import Bool, Count, Meters, MetersPerSecond, Seconds


class FootprintOrca(BehaviorOptions):
    """Avoid others by their true outlines instead of circles, go round what stands, and never touch alike ones.

    It is for crowds of robots, above all where those that have arrived stay in the way. As under `orca` each of two
    makes half of the avoidance, and all of it for those that do not give way. Of some tens of velocities it takes the
    one that loses least on the way to the goal and risks least within the time horizon. It only takes what leaves it in
    its own part of the gap to each other one: robots which all run it do not touch, as long as their drives are exact,
    `acce` does not limit how they brake and no more than `maxNeighbors` are that near. Robots that stand, arrived ones
    and static obstacles within 5 m are passed on a way that is searched on a grid of 0.1 m, at most 4 m aside; others
    that stay longer are passed, too, once it has made no progress for 1.2 s; then it also tries random directions,
    which follow the seed. Arrived robots make room for others, and come back. It sees no goals of others. Around larger
    walls use `follow` with `footprint_orca` as its `local`.
    """

    in_group: ClassVar[bool] = True

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "footprint_orca"}]}

    name: Literal["footprint_orca"] = "footprint_orca"
    neighborDist: Annotated[Meters, Field(gt=0)] = 5.0
    """Moving objects farther away than this are ignored, unless they stand in the way."""
    maxNeighbors: Count = 8
    """Number of moving objects considered, nearest first; walls and static circles do not count."""
    timeHorizon: Annotated[Seconds, Field(gt=0)] = 1.5
    """Time horizon within which collisions with moving objects are avoided; twice this for those that run something
    else."""
    timeHorizonObst: Annotated[Seconds, Field(gt=0)] = 0.5
    """Time horizon within which collisions with walls and with everything that has stopped are avoided."""
    safe_distance: Annotated[Meters, Field(ge=0)] = 0.02
    """Distance kept from others where there is room, 0.1 m more from moving ones that run something else."""
    maxSpeed: Annotated[MetersPerSecond, Field(gt=0)] | None = None
    """Largest speed; null is the speed that the object can reach in every direction, which is also the upper limit."""
    backward: Bool = True
    """Whether an object that cannot move sideways also drives backward, if its `vel_min` allows it: turning round takes
    longer."""


BEHAVIORS.register(FootprintOrca, kernel=core.FootprintOrcaOptions)
