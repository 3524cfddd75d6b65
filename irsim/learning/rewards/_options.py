"""The registry of reward terms, and the options that all of them have in common."""

from __future__ import annotations

from irsim.options.base import Options
from irsim.options.registry import Registry
from irsim.options.units import Number

__all__ = ["REWARDS", "RewardOptions"]

REWARDS = Registry("reward", "irsim.learning.rewards", "irsim.rewards", families=("terms",))
"""Terms of rewards: a kernel of the core, or a function of :class:`irsim.learning.step.Moment` over all learners."""


class RewardOptions(Options):
    """Keys that every reward term takes."""

    name: str
    """Name of the term."""
    weight: Number = 1.0
    """Factor of the term; negative for a cost."""
