"""Actions that are executed some steps after they were decided."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats

__all__ = ["Latency"]


class Latency:
    """Keeps the last actions of all learners.

    Args:
        most: Largest latency [steps].
        worlds: Number of worlds.
        learners: Number of learners in each.

    Attributes:
        steps: (n * A,) latency of each learner.
    """

    def __init__(self, most: int, worlds: int, learners: int) -> None:
        self._most, self._learners = most, learners
        self._slots = np.arange(worlds * learners)
        self._sent: Floats | None = None
        self._now = 0
        self.steps: NDArray[np.int64] = np.zeros(worlds * learners, dtype=np.int64)

    def pass_on(self, numbers: Floats, count: NDArray[np.int64]) -> tuple[Floats, NDArray[np.bool_]]:
        """The actions that are executed now.

        Args:
            numbers: (n * A, F) actions that were decided now.
            count: (n,) steps of the present episodes.

        Returns:
            (n * A, F) actions, and (n * A,) whether a learner still waits for its first one.
        """
        if self._sent is None:
            self._sent = np.zeros((self._most + 1, *numbers.shape))
        self._now = (self._now + 1) % len(self._sent)
        self._sent[self._now] = numbers
        found = self._sent[(self._now - self.steps) % len(self._sent), self._slots]
        return found, np.repeat(count, self._learners) < self.steps
