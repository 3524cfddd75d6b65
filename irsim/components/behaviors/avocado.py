"""``avocado``: collision avoidance that learns how much each other object gives way."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import BehaviorOptions
from irsim.options.knowledge import Fact
from irsim.options.registry import BEHAVIORS
from irsim.options.units import Bool, Count, Degrees, Fraction, Hertz, Meters, MetersPerSecond, Number, Seconds


class Avocado(BehaviorOptions):
    """Avoid others as `orca` does, but learn how much of the avoidance each of them leaves.

    It forms an opinion of every moving object near it, and yields more to one that does not react, less to one that
    gives way. Use it where it is unknown who gives way. Neutral is the half that `orca` makes. Walls,
    dead ends, limits, `acce` and goals are as in `orca`, but cars touch where many meet: use `orca`
    there. Weak noise breaks symmetry; seed and place in the file decide it. Letters in brackets
    are the paper's.
    """

    in_group: ClassVar[bool] = True
    avoids: ClassVar[bool] = True
    knows: ClassVar[frozenset[Fact]] = frozenset({"circles", "laws", "static"})

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "avocado", "neighborDist": 5.0}]}

    also_called: ClassVar[dict[str, str]] = {
        "a": "own_weight",
        "b": "bias",
        "c": "evidence_weight",
        "d": "forgetting",
        "delta": "attention_step",
        "epsilon": "evidence_gain",
        "eta": "noise",
        "kappa": "attention_time",
    }

    name: Literal["avocado"] = "avocado"
    neighborDist: Annotated[Meters, Field(gt=0)] = 2.5
    """Moving objects farther away are ignored and forgotten."""
    maxNeighbors: Count = 15
    """Number of moving objects considered, nearest first."""
    timeHorizon: Annotated[Seconds, Field(gt=0)] = 2.5
    """Time horizon for collisions with moving objects."""
    timeHorizonObst: Annotated[Seconds, Field(gt=0)] = 2.5
    """The same for walls and static circles."""
    safe_radius: Annotated[Meters, Field(ge=0)] | None = None
    """Margin added to the radius of the object itself; null is a tenth of that radius."""
    maxSpeed: Annotated[MetersPerSecond, Field(gt=0)] | None = None
    """Largest speed; null is what the object can reach in every direction."""
    approach_time: Annotated[Seconds, Field(gt=0)] | None = None
    """As in `orca`; null is full speed."""
    sidestep: Annotated[Degrees, Field(ge=-45, le=45)] | None = None
    """As in `orca`: null breaks ties only."""
    forgetting: Annotated[Hertz, Field(gt=0)] = 2.0
    """Rate at which an opinion goes to what attention and evidence say (`d`)."""
    own_weight: Annotated[Number, Field(ge=0)] = 0.3
    """Weight of the opinion itself: a larger one is kept against the evidence (`a`)."""
    evidence_weight: Annotated[Number, Field(ge=0)] = 0.7
    """Weight of the evidence: how much of the needed change of velocity the other has made in the last step (`c`)."""
    evidence_gain: Annotated[Number, Field(ge=0)] = 3.22
    """Steepness with which more than half of the needed change counts as giving way, and less as not (`epsilon`)."""
    evidence: Literal["neutral", "authors"] = "neutral"
    """Evidence where no change was needed, as at first sight: none, or, as the authors' program, of no reaction."""
    memory: Bool = False
    """Keep opinions of objects out of reach, as the authors' program."""
    bias: Hertz = 0.0
    """Constant change of an opinion: positive trusts others. It starts at the bias divided by `forgetting` (`b`)."""
    attention_time: Annotated[Seconds, Field(gt=0)] = 14.15
    """A collision within about this time gets the full attention, one much later none (`kappa`)."""
    attention_step: Fraction = 0.57
    """Share of the attention that is renewed in each step (`delta`)."""
    noise: Annotated[MetersPerSecond, Field(ge=0)] = 1e-4
    """Largest noise on the velocity of another object while it gets no attention: it ends deadlocks (`eta`)."""
    keep_gap: bool | None = None
    """Take at most 2/5 of a gap to a circle in a step; null: robots do for 7 s after a tie of either."""

    def draws(self) -> bool:
        """Whether there is noise."""
        return self.noise > 0


BEHAVIORS.register(Avocado, kernel=core.AvocadoOptions)
