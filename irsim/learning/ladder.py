"""The way of a training through the levels of a curriculum."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.learning.step import Result
from irsim.learning.tasks.task import Curriculum
from irsim.learning.workers.divided import AnyWorlds

__all__ = ["Ladder"]


class Ladder:
    """Counts successes, and sets the level of worlds: a learner succeeds when it arrives and does not collide.

    An episode counts if its world was at the present level. After a move the count starts at 0.

    Args:
        worlds: The worlds.
        curriculum: The curriculum of their task.

    Attributes:
        level: The present level.
    """

    def __init__(self, worlds: AnyWorlds, curriculum: Curriculum) -> None:
        self._worlds, self._curriculum = worlds, curriculum
        self.level = curriculum.start
        self._recent: NDArray[np.bool_] = np.zeros(0, dtype=bool)
        self.begin_episodes()

    def begin_episodes(self) -> None:
        """Forget what learners have done in episodes that were broken off."""
        shape = (self._worlds.n, self._worlds.learners)
        self._came, self._hit = np.zeros(shape, dtype=bool), np.zeros(shape, dtype=bool)

    def facts(self) -> dict[str, Any]:
        """Facts from which :meth:`restore` goes on."""
        return {"level": self.level, "recent": "".join("1" if one else "0" for one in self._recent.tolist())}

    def restore(self, facts: Mapping[str, Any]) -> None:
        """Go on from facts of an earlier ladder. The next episodes are of its level."""
        self.level = int(facts["level"])
        self._recent = np.array([one == "1" for one in facts["recent"]], dtype=bool)
        self._worlds.set_level(self.level)

    def watch(self, result: Result) -> None:
        """Count the episodes that end in a step, and move; call it before worlds that are over are reset."""
        self._came |= result.arrived
        self._hit |= result.collided
        ended = (result.terminated | result.truncated) & (self._worlds.level == self.level)[:, None]
        good = (self._came & ~self._hit)[ended]
        self._came[result.over], self._hit[result.over] = False, False
        if not good.size:
            return
        self._recent = np.concatenate([self._recent, good])[-self._curriculum.episodes :]
        if len(self._recent) < self._curriculum.episodes:
            return
        share = float(self._recent.mean())
        if share >= self._curriculum.up and self.level + 1 < len(self._curriculum.levels):
            self._move(self.level + 1)
        elif self._curriculum.down is not None and share <= self._curriculum.down and self.level > 0:
            self._move(self.level - 1)

    def _move(self, level: int) -> None:
        self.level = level
        self._recent = np.zeros(0, dtype=bool)
        self._worlds.set_level(level)
