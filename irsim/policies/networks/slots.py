"""What a network remembers of each robot from one decision to the next."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from irsim.policies.networks.values import Array
from irsim.policies.observations import Observations

__all__ = ["Slots"]


class Slots:
    """One row of numbers for each robot of each world, given to it at its first decision.

    Args:
        sizes: Label of a layer -> how many numbers it remembers.
        dtype: Type of the numbers.
    """

    def __init__(self, sizes: Mapping[str, int], dtype: np.dtype[np.floating]) -> None:
        self._slots: dict[tuple[int, int], int] = {}
        self._memory: dict[str, Array] = {label: np.zeros((0, size), dtype) for label, size in sizes.items()}

    def recall(self, observations: Observations) -> tuple[NDArray[np.intp], dict[str, Array]]:
        """The row of each robot, and what was remembered: zeros at the first decision of an episode."""
        keys = zip(observations.world.tolist(), observations.robot.tolist(), strict=True)
        known = self._slots
        rows = np.array([known.setdefault(key, len(known)) for key in keys], dtype=np.intp)
        for label, memory in self._memory.items():
            if len(memory) < len(known):
                grown = np.zeros((max(len(known), 2 * len(memory)), memory.shape[1]), memory.dtype)
                grown[: len(memory)] = memory
                self._memory[label] = grown
        fresh = observations.first[:, None]
        return rows, {label: np.where(fresh, 0, memory[rows]) for label, memory in self._memory.items()}

    def store(self, rows: NDArray[np.intp], remembered: Mapping[str, Array]) -> None:
        """Keep what layers have written."""
        for label, memory in remembered.items():
            self._memory[label][rows] = memory
