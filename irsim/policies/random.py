"""``random``: uniform controls within the limits of each robot, a baseline and a test of anything else."""

from __future__ import annotations

import numpy as np

from irsim.common.arrays import Floats
from irsim.policies.observations import Observations
from irsim.policies.policy import Episode, Policy
from irsim.policies.registry import RANDOM

__all__ = ["RandomPolicy"]


class RandomPolicy(Policy):
    """Draws each control uniformly between its limits; an infinite limit counts as 1.

    Args:
        decision_dt: Time for which a control is kept [s].
    """

    batch_invariant = True

    def __init__(self, decision_dt: float | None = None) -> None:
        self.name = RANDOM
        self.decision_dt = decision_dt
        self._rng: dict[int, np.random.Generator] = {}

    def reset(self, episode: Episode, rng: np.random.Generator) -> None:
        """Keep the stream of the world."""
        self._rng[episode.world] = rng

    def act(self, observations: Observations) -> Floats:
        """Uniform controls, (B, 3)."""
        low = np.where(np.isfinite(observations.low), observations.low, -1.0)
        high = np.where(np.isfinite(observations.high), observations.high, 1.0)
        worlds, counts = np.unique(observations.world, return_counts=True)  # rows are sorted by world
        parts = [self._rng[w].random((n, 3)) for w, n in zip(worlds.tolist(), counts.tolist(), strict=True)]
        drawn: Floats = low + (high - low) * np.concatenate(parts)
        return drawn
