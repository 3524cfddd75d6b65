"""``orca``: optimal reciprocal collision avoidance."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.behaviors._options import BehaviorOptions
from irsim.options.registry import BEHAVIORS
from irsim.options.units import Count, Meters, MetersPerSecond, Seconds


class Orca(BehaviorOptions):
    """Take half of the smallest change of velocity that avoids every collision, and leave the rest to the other.

    Movers that are not driven by orca are avoided by the whole change; what stands still is never driven into.
    It knows walls, the largest speed and turn rate and the turning of a car, but not `acce`; everybody is the circle
    round its footprint, also long rectangles. Robots that have arrived still give way, leave their goals for that and
    come back. It stays caught in dead ends, and leaves finding a way round walls to `follow` with it as `local`.
    """

    in_group: ClassVar[bool] = True

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "orca", "neighborDist": 10.0, "timeHorizon": 5.0}]}

    name: Literal["orca"] = "orca"
    neighborDist: Annotated[Meters, Field(gt=0)] = 15.0
    """Movers farther away than this are ignored."""
    maxNeighbors: Count = 10
    """Most movers considered, nearest first; walls and standing circles do not count."""
    timeHorizon: Annotated[Seconds, Field(gt=0)] = 20.0
    """How far ahead collisions with movers are avoided. Long ones make crowds slow."""
    timeHorizonObst: Annotated[Seconds, Field(gt=0)] = 10.0
    """How far ahead collisions with walls and standing circles are avoided. Wherever there are walls set 1 to 2 s: with
    the default robots slow down in corridors and creep to goals near walls."""
    safe_radius: Annotated[Meters, Field(ge=0)] = 0.1
    """Added to the own radius."""
    maxSpeed: Annotated[MetersPerSecond, Field(gt=0)] | None = None
    """Largest speed, and at most what the object can do in every direction; null is just that."""


BEHAVIORS.register(Orca, kernel=core.OrcaOptions)
