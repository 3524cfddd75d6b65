"""What has been experienced: decisions, rewards, and what followed."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats

__all__ = ["Experience", "Memory"]

Rows = NDArray[np.float32]


class Experience:
    """Decisions of one or many episodes.

    Attributes:
        state: (N, D) joint states before the decisions.
        reward: (N,) rewards until the next decision, each step's discounted to the decision.
        following: (N, D) joint states at the next decision.
        discount: (N,) factor of the value of what follows; 0 where the episode of the learner has ended.
        gain: (N,) discounted sum of all rewards until the end of the episode.
    """

    def __init__(self, state: Rows, reward: Floats, following: Rows, discount: Floats, gain: Floats) -> None:
        self.state, self.following = state, following
        self.reward, self.discount, self.gain = (np.asarray(x, np.float32) for x in (reward, discount, gain))

    def __len__(self) -> int:
        return len(self.state)


class Memory:
    """The last decisions, a ring.

    Args:
        size: How many.
        width: Numbers of a state, D.
    """

    def __init__(self, size: int, width: int) -> None:
        self.state = np.zeros((size, width), dtype=np.float32)
        self.following = np.zeros((size, width), dtype=np.float32)
        self.reward = np.zeros(size, dtype=np.float32)
        self.discount = np.zeros(size, dtype=np.float32)
        self.count = self.place = 0

    def __len__(self) -> int:
        return self.count

    def add(self, found: Experience) -> None:
        """Remember decisions, instead of the oldest ones."""
        size = len(self.state)
        kept = np.arange(max(0, len(found) - size), len(found))
        places = (self.place + kept) % size
        for name in ("state", "following", "reward", "discount"):
            getattr(self, name)[places] = getattr(found, name)[kept]
        self.place = (self.place + len(found)) % size
        self.count = min(self.count + len(found), size)

    def contents(self) -> dict[str, Any]:
        """Everything, as arrays and numbers."""
        arrays = {name: getattr(self, name)[: self.count] for name in ("state", "following", "reward", "discount")}
        return {**arrays, "place": self.place}

    def restore(self, contents: dict[str, Any]) -> None:
        """Remember what :meth:`contents` has returned."""
        self.count, self.place = len(contents["state"]), int(contents["place"])
        for name in ("state", "following", "reward", "discount"):
            getattr(self, name)[: self.count] = contents[name]
