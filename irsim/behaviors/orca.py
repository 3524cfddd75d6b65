"""``orca``: optimal reciprocal collision avoidance."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim import _core as core
from irsim.behaviors._options import BehaviorOptions
from irsim.registry import BEHAVIORS
from irsim.units import Count, Meters, MetersPerSecond, Seconds


class Orca(BehaviorOptions):
    """Each member of a group takes half of the smallest change of velocity that avoids every collision."""

    in_group: ClassVar[bool] = True

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "orca", "neighborDist": 10.0, "timeHorizon": 5.0}]}

    name: Literal["orca"] = "orca"
    neighborDist: Annotated[Meters, Field(gt=0)] = 15.0
    """Others farther away than this are ignored."""
    maxNeighbors: Count = 10
    """Most neighbours considered, nearest first."""
    timeHorizon: Annotated[Seconds, Field(gt=0)] = 20.0
    """How far ahead collisions with agents are avoided."""
    timeHorizonObst: Annotated[Seconds, Field(gt=0)] = 10.0
    """How far ahead collisions with walls are avoided."""
    safe_radius: Annotated[Meters, Field(ge=0)] = 0.1
    """Added to the radius of each agent."""
    maxSpeed: Annotated[MetersPerSecond, Field(gt=0)] | None = None
    """Largest speed; null is the object's own."""


BEHAVIORS.register(Orca, kernel=core.OrcaOptions)
