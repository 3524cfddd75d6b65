"""``progress``: metres that a learner has come nearer to its goal."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import irsim._core as core
from irsim.learning.features import REWARDS
from irsim.learning.rewards._options import RewardOptions


class Progress(RewardOptions):
    """Metres by which the straight distance to the goal has shrunk; negative when it has grown.

    The sum over an episode does not depend on the way that is taken (potential-based shaping, Ng, Harada and Russell
    1999), so that this term alone changes no optimal policy.
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "progress", "weight": 1.0}]}

    name: Literal["progress"] = "progress"


REWARDS.register(Progress, kernel=core.ProgressOptions)
