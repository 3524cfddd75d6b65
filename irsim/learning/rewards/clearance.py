"""``clearance``: how far a learner is inside a margin around others."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from irsim.common.arrays import Floats
from irsim.learning.features import REWARDS
from irsim.learning.moment import Moment
from irsim.learning.rewards._options import RewardOptions
from irsim.options.units import Meters, Number

_COLUMNS = {"robots": (0,), "obstacles": (1, 2), "all": (0, 1, 2)}


class Clearance(RewardOptions):
    """The share of `margin` that is missing between the footprints of a learner and of what is nearest, per second.

    0 from a gap of `margin` on, 1 for a touch.
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "clearance", "weight": -1.5, "margin": 0.15}]}

    name: Literal["clearance"] = "clearance"
    weight: Number = -1.0
    """Factor of the term; negative for a cost."""
    margin: Annotated[Meters, Field(gt=0)] = 0.2
    """Gap from which on nothing is missing."""
    to: Literal["all", "robots", "obstacles"] = "all"
    """What keeps the learner at a distance: other robots, obstacles (static and moving ones), or all of them."""


@REWARDS.register(Clearance)
def clearance(moment: Moment, options: Clearance) -> Floats:
    """(n, A) missing share, times the duration of the step [s]."""
    return moment.step_time * missing_share(moment, options.margin, _COLUMNS[options.to])


def missing_share(moment: Moment, margin: float, kinds: tuple[int, ...]) -> Floats:
    """(n, A) share of a margin [m] that is missing to the nearest object of these kinds, 0 to 1."""
    gap = moment.gaps(margin)[..., list(kinds)].min(axis=-1)
    missing: Floats = np.clip((margin - gap) / margin, 0.0, 1.0)
    return missing
