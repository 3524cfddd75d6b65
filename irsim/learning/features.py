"""The registry of reward terms."""

from __future__ import annotations

from irsim.options.registry import Registry

__all__ = ["REWARDS"]

REWARDS = Registry("reward", "irsim.learning.rewards", "irsim.rewards")
"""Terms of rewards: each is a function of :class:`irsim.learning.moment.Moment`, over all learners at once."""
