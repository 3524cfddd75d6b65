"""The memory of PPO without the steps in which slots waited for their worlds."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import numpy as np

from irsim.common.extras import require

require("learn", "torch", "stable_baselines3")
from stable_baselines3.common.buffers import RolloutBuffer, RolloutBufferSamples

__all__ = ["MaskedRolloutBuffer"]


class MaskedRolloutBuffer(RolloutBuffer):  # type: ignore[misc] # types of an extra are not read
    """Keeps which steps counted (``active``), and samples from those only.

    Attributes:
        active: (steps, slots) set by the environment's owner before each :meth:`add`.
        now: (slots,) whether the step that is added next counts.
    """

    now: Any = None
    generator_ready: bool

    def reset(self) -> None:
        """Forget everything."""
        super().reset()
        self.active = np.ones((self.buffer_size, self.n_envs), dtype=bool)

    def add(self, *args: Any, **kwargs: Any) -> None:
        """Add a step of all slots."""
        if self.now is not None:
            self.active[self.pos] = self.now
        super().add(*args, **kwargs)

    def get(self, batch_size: int | None = None) -> Generator[RolloutBufferSamples, None, None]:
        """Minibatches of the steps that counted, in random order and of nearly equal sizes."""
        assert self.full, "the buffer is sampled when it is full"
        if not self.generator_ready:
            for name in ("observations", "actions", "values", "log_probs", "advantages", "returns"):
                self.__dict__[name] = self.swap_and_flatten(self.__dict__[name])
            self.active = self.swap_and_flatten(self.active[..., None])[:, 0]
            self.generator_ready = True
        chosen = np.random.permutation(np.flatnonzero(self.active))  # noqa: NPY002 - the stream that SB3 seeds
        count = max(1, -(-len(chosen) // (batch_size or len(chosen) or 1)))
        for indices in np.array_split(chosen, count):
            if len(indices) > 1:  # the advantage of a single step has no deviation to divide by
                yield self._get_samples(indices)
