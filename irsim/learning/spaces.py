"""Spaces of observations and actions, as Gymnasium has them."""

from __future__ import annotations

from typing import Any

import numpy as np

from irsim.common.extras import require
from irsim.learning.workers.divided import AnyWorlds

require("gym", "gymnasium")
from gymnasium import spaces

__all__ = ["action_space", "observation_space"]


def observation_space(worlds: AnyWorlds) -> spaces.Box:
    """The box of the observations of one learner."""
    return spaces.Box(worlds.eyes.low, worlds.eyes.high, dtype=np.float32)


def action_space(worlds: AnyWorlds) -> spaces.Space[Any]:
    """The box of numbers from -1 to 1 of an action, or the numbers of the choices."""
    choices = worlds.task.action.choices
    if choices is not None:
        return spaces.Discrete(len(choices))
    return spaces.Box(-1.0, 1.0, (worlds.width,), dtype=np.float32)
