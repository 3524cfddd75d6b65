"""The registry of reward terms."""

from __future__ import annotations

from irsim.options.registry import Registry

__all__ = ["REWARDS"]

REWARDS = Registry("reward", "irsim.learning.rewards", "irsim.rewards")
"""Terms of rewards: a kernel of the core, or a function of :class:`irsim.learning.step.Moment` over all learners."""
