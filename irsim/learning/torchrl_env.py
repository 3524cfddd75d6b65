"""Worlds of a task as a batched environment of TorchRL."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.extras import require
from irsim.common.keywords import answers_misspelt
from irsim.learning.tasks.files import TaskSource
from irsim.learning.workers.divided import open_slots

require("learn", "torch", "torchrl", "tensordict")
import torch
from tensordict import TensorDict, TensorDictBase
from torchrl.data import Bounded, Categorical, Composite, Unbounded
from torchrl.envs import EnvBase

__all__ = ["TorchRLEnv"]


class TorchRLEnv(EnvBase):  # type: ignore[misc] # types of an extra are not read
    """``num_envs`` learners as an environment of that batch size, locked; n worlds with A learners make n * A entries.

    Learners of one world have neighboring entries. An entry whose episode is over before its world's has the
    reward 0 and ``active`` False; it is reset with its world.

    Args:
        task: The task: its file, its data, or a task that was read.
        num_envs: Number of entries; a multiple of the number of learners in a world. Default: one world.
        worlds: Number of worlds, instead of ``num_envs``.
        seed: Seed of the first world, the next one has the next number; None: ``seeds.train`` of the task.
        threads: Number of threads of all processes together; results do not depend on it.
        workers: Number of processes that the worlds are divided among, this one included; results do not depend on it.
            Reward functions in Python get the worlds of their process.
        device: Device of the tensors; the simulation runs on the CPU.

    Attributes:
        worlds: The worlds behind it.

    Raises:
        TaskError: The task is not valid, or does not fit its scenario.
        ScenarioError: The scenario cannot be used.
        ArgumentError: There is no such number of workers.
    """

    batch_locked = True

    @answers_misspelt
    def __init__(
        self,
        task: TaskSource,
        num_envs: int | None = None,
        *,
        worlds: int | None = None,
        seed: int | None = None,
        threads: int = 1,
        workers: int = 1,
        device: Any = "cpu",
    ) -> None:
        made = open_slots(task, num_envs, worlds, seed=seed, threads=threads, workers=workers)
        size = torch.Size([made.n * made.learners])
        super().__init__(device=device, batch_size=size)
        self.worlds = made
        self._fresh = True
        eyes, choices = made.eyes, made.task.action.choices
        low, high = (torch.as_tensor(bound).expand(*size, eyes.size) for bound in (eyes.low, eyes.high))
        flag = Categorical(2, shape=(*size, 1), dtype=torch.bool)
        seen = Bounded(low, high, dtype=torch.float32)
        self.observation_spec = Composite(observation=seen, active=flag.clone(), shape=size)
        if choices is None:
            self.action_spec = Bounded(-1.0, 1.0, shape=(*size, made.width), dtype=torch.float32)
        else:
            self.action_spec = Categorical(len(choices), shape=size, dtype=torch.int64)
        self.reward_spec = Unbounded(shape=(*size, 1), dtype=torch.float32)
        self.done_spec = Composite(done=flag.clone(), terminated=flag.clone(), truncated=flag.clone(), shape=size)

    def _reset(self, tensordict: TensorDictBase | None = None, **kwargs: Any) -> TensorDictBase:
        mask = None
        if tensordict is not None and "_reset" in tensordict.keys():  # noqa: SIM118 - a TensorDict has no other way
            asked = tensordict["_reset"].reshape(self.worlds.n, self.worlds.learners).cpu().numpy()
            mask = asked.any(axis=1)
        if mask is not None or not self._fresh:
            self.worlds.reset(mask)
        self._fresh = False
        active = self.worlds.present.reshape(-1)
        return self._dict(self.worlds.observe(), active=active)

    def _step(self, tensordict: TensorDictBase) -> TensorDictBase:
        actions = self.worlds.read(tensordict["action"].detach().cpu().numpy())
        step = self.worlds.advance(actions)
        result = step.result
        over = np.repeat(result.over, self.worlds.learners)
        terminated, truncated = result.terminated.reshape(-1), result.truncated.reshape(-1)
        waiting = over & ~result.active.reshape(-1)
        out = self._dict(
            step.seen,
            active=result.active.reshape(-1),
            terminated=terminated,
            truncated=truncated | waiting,
            done=terminated | truncated | waiting,
        )
        out["reward"] = torch.as_tensor(result.reward.reshape(-1, 1), dtype=torch.float32, device=self.device)
        return out

    def _dict(self, observed: NDArray[np.float32], **flags: Any) -> TensorDictBase:
        seen = torch.from_numpy(observed)  # shares the memory of the array
        columns = {name: torch.as_tensor(flag).reshape(-1, 1) for name, flag in flags.items()}
        made = {"observation": seen, **columns}
        return TensorDict(made, batch_size=self.batch_size).to(self.device)

    def set_level(self, level: int) -> None:
        """Set the level of the curriculum of the episodes that start from now on."""
        self.worlds.set_level(level)

    def close(self, **kwargs: Any) -> None:
        """End the worker processes."""
        super().close(**kwargs)
        self.worlds.close()

    def _set_seed(self, seed: int | None) -> None:
        first = 0 if seed is None else seed
        self.worlds.reset(seeds=[first + i for i in range(self.worlds.n)])
        self._fresh = True
