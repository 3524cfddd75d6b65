"""``footprint_orca``: reciprocal collision avoidance with the true outlines of bodies."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.behaviors._options import BehaviorOptions
from irsim.options.registry import BEHAVIORS
from irsim.options.units import Bool, Count, Meters, MetersPerSecond, Seconds


class FootprintOrca(BehaviorOptions):
    """Avoid others as `orca` does, with true outlines instead of circles, and never touch those that do the same."""

    in_group: ClassVar[bool] = True

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "footprint_orca"}]}

    name: Literal["footprint_orca"] = "footprint_orca"
    neighborDist: Annotated[Meters, Field(gt=0)] = 3.0
    """Moving objects farther away than this are ignored."""
    maxNeighbors: Count = 8
    """Number of moving objects considered, nearest first."""
    timeHorizon: Annotated[Seconds, Field(gt=0)] = 1.5
    """Time horizon within which collisions with moving objects are avoided."""
    timeHorizonObst: Annotated[Seconds, Field(gt=0)] = 0.5
    """Time horizon within which collisions with what stands are avoided."""
    safe_distance: Annotated[Meters, Field(ge=0)] = 0.02
    """Distance kept from others."""
    maxSpeed: Annotated[MetersPerSecond, Field(gt=0)] | None = None
    """Largest speed; null is the limit of the object."""
    backward: Bool = True
    """Whether an object with a drive that cannot move sideways also drives backward, where `vel_min` allows it."""


BEHAVIORS.register(FootprintOrca, kernel=core.FootprintOrcaOptions)
