"""``orca``: optimal reciprocal collision avoidance."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.behaviors._people import FittedOptions
from irsim.options.knowledge import Fact
from irsim.options.registry import BEHAVIORS
from irsim.options.units import Count, Degrees, Fraction, Meters, MetersPerSecond, Seconds


class Orca(FittedOptions):
    """Take half of the smallest change of velocity that avoids every collision, and leave the rest to the other.

    It makes the whole change for moving objects that run no kind of orca, and never drives into static ones.
    It respects walls, limits of speed and turning, the steering of a car, and `acce`: it brakes in time, whatever its
    horizons. Every object counts as the circle round its footprint. Robots that have arrived still give way and come
    back. A wall that stands free is passed on the nearer side. Boxes that touch are walls of their own; a `compound` is
    one. It does not get out of dead ends: use it as the `local` of `follow`.
    """

    in_group: ClassVar[bool] = True
    avoids: ClassVar[bool] = True
    knows: ClassVar[frozenset[Fact]] = frozenset({"circles", "arrivals", "laws", "static"})

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "orca", "neighborDist": 10.0, "timeHorizon": 5.0}]}

    name: Literal["orca"] = "orca"
    neighborDist: Annotated[Meters, Field(gt=0)] = 15.0
    """Moving objects farther away are ignored; walls hide none."""
    maxNeighbors: Count = 10
    """Moving objects considered, nearest first; walls and static circles do not count."""
    timeHorizon: Annotated[Seconds, Field(gt=0)] = 20.0
    """Time horizon for moving objects. A long one makes crowds slow."""
    timeHorizonObst: Annotated[Seconds, Field(gt=0)] = 10.0
    """The same for walls and static circles. Near walls set 1 to 2 s: the default makes robots slow in corridors
    and at goals near walls."""
    safe_radius: Annotated[Meters, Field(ge=0)] = 0.1
    """Margin added to its own radius."""
    maxSpeed: Annotated[MetersPerSecond, Field(gt=0)] | None = None
    """Largest speed; null is what the object can reach in every direction, also the upper limit."""
    responsibility: Annotated[Fraction, Field(gt=0)] | None = None
    """Share of that change of velocity that it makes for a moving object; null is half for one that runs a kind of orca
    and sees it, else all. Most other programs always take 0.5."""
    approach_time: Annotated[Seconds, Field(gt=0)] | None = None
    """Slow down at the goal: the wanted speed is at most the distance to it divided by this time; null is full
    speed."""
    sidestep: Annotated[Degrees, Field(ge=-45, le=45)] | None = None
    """While something that moves is ahead on the way to the goal, want to pass it on one side: the wanted velocity
    turns by this angle to the right, to the left if negative, and by up to 90 degrees the slower the object drives.
    10 passes a slower one straight ahead. null only breaks ties: two mirror images, such as two that meet head-on, both
    pass on their right, as does one with a circle exactly ahead. 0 leaves ties: all brake, and may stand."""


BEHAVIORS.register(Orca, kernel=core.OrcaOptions)
