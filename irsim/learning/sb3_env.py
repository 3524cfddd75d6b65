"""Learners of many worlds as the vector environment of Stable-Baselines3."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.extras import require
from irsim.common.keywords import answers_misspelt
from irsim.diagnostics.errors import ArgumentError
from irsim.learning.gym_env import action_space, observation_space
from irsim.learning.ladder import Ladder
from irsim.learning.pictures import Camera
from irsim.learning.tasks.files import TaskSource
from irsim.learning.workers.divided import open_slots

require("learn", "stable_baselines3")
from stable_baselines3.common.vec_env import VecEnv

__all__ = ["SB3VecEnv"]


class SB3VecEnv(VecEnv):  # type: ignore[misc] # types of an extra are not read
    """Each learner of each world is a slot, so that all share one policy.

    A slot waits when its episode is over before its world's: it earns nothing, and :attr:`active` is False.
    Facts of whole episodes come in ``infos[slot]["episode"]``: ``r``, ``l`` and ``is_success``, as
    :class:`stable_baselines3.common.monitor.Monitor` has them, and in ``infos[slot]["contacts_between_steps"]``: the
    number of contacts of the episode that began and ended within one step.

    Args:
        task: The task: its file, its data, or a task that was read.
        num_envs: Number of slots; a multiple of the number of learners in a world. Default: one world.
        worlds: Number of worlds, instead of ``num_envs``.
        seed: Seed of the first world, the next one has the next number; None: ``seeds.train`` of the task.
        threads: Number of threads of all processes together; results do not depend on it.
        workers: Number of processes that the worlds are divided among, this one included; results do not depend on it.
            Reward functions in Python get the worlds of their process.

    Attributes:
        worlds: The worlds behind it.
        active: (num_envs,) whether the last step counted for a slot; it does not for slots that waited.
        ladder: Moves the worlds through the levels of the curriculum of the task; None without one.

    Raises:
        TaskError: The task is not valid, or does not fit its scenario.
        ScenarioError: The scenario cannot be used.
        ArgumentError: There is no such number of workers.
    """

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
    ) -> None:
        self.worlds = open_slots(task, num_envs, worlds, seed=seed, threads=threads, workers=workers)
        slots = self.worlds.n * self.worlds.learners
        self.render_mode = "rgb_array"
        self._camera = Camera(self.worlds)
        curriculum = self.worlds.task.curriculum
        self.ladder = None if curriculum is None else Ladder(self.worlds, curriculum)
        self._actions: Any = None
        self._fresh = True
        self._length = np.zeros(slots, dtype=np.int64)
        self._return = np.zeros(slots)
        self.active = np.ones(slots, dtype=bool)
        super().__init__(slots, observation_space(self.worlds), action_space(self.worlds))

    def reset(self) -> NDArray[np.float32]:
        """Start an episode in every world: the next scene, or the first one of seeds given to :meth:`seed`."""
        seeds = [seed for seed in self._seeds if seed is not None][: self.worlds.n]
        if seeds:
            self.worlds.reset(seeds=seeds)
        elif not self._fresh:
            self.worlds.reset()
        self._fresh = False
        self._reset_seeds()
        if self.ladder is not None:
            self.ladder.begin_episodes()
        self._length[:], self._return[:], self.active[:] = 0, 0.0, True
        self.reset_infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        return self.worlds.observe()

    def step_async(self, actions: NDArray[Any]) -> None:
        """Keep the actions for :meth:`step_wait`."""
        self._actions = actions

    def step_wait(self) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """Advance all worlds by one period; worlds that are over start their next episode at once."""
        worlds = self.worlds
        watch = None if self.ladder is None else self.ladder.watch
        step = worlds.advance(worlds.read(self._actions), "over", watch=watch)
        result = step.result
        reward, active = result.reward.reshape(-1), result.active.reshape(-1)
        terminated, truncated = result.terminated.reshape(-1), result.truncated.reshape(-1)
        over = np.repeat(result.over, worlds.learners)
        done = terminated | truncated | over
        self.active = active
        self._length += active
        self._return += reward
        infos: list[dict[str, Any]] = [{"active": flag} for flag in active.tolist()]
        for slot in np.flatnonzero(terminated | truncated).tolist():
            episode = {"r": float(self._return[slot]), "l": int(self._length[slot])}
            success = bool(result.arrived.reshape(-1)[slot])
            infos[slot] |= {"episode": episode, "is_success": success, "TimeLimit.truncated": bool(truncated[slot])}
            infos[slot]["contacts_between_steps"] = int(result.contacts_between_steps.reshape(-1)[slot])
        for slot in np.flatnonzero(done).tolist():
            infos[slot]["terminal_observation"] = (step.last if over[slot] else step.seen)[slot].copy()
        self._length[done], self._return[done] = 0, 0.0
        return step.seen, reward.astype(np.float32), done, infos

    def set_level(self, level: int) -> None:
        """Set the level of the curriculum of the episodes that start from now on, as the ladder does when it moves."""
        self.worlds.set_level(level)
        if self.ladder is not None:
            self.ladder.restore({"level": level, "recent": ""})

    def close(self) -> None:
        """Close the window, and end the worker processes."""
        self.worlds.close()
        self._camera.close()

    def get_images(self) -> Sequence[NDArray[np.uint8] | None]:
        """A picture of the first world."""
        return [self._camera.picture()]

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """An attribute of this object, once for each slot."""
        return [getattr(self, attr_name)] * len(list(self._get_indices(indices)))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Refuse: slots have no attributes of their own."""
        raise ArgumentError("slots have no attributes of their own", "set attributes of the environment itself")

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        """The result of a method of this object, once for each slot."""
        result = getattr(self, method_name)(*method_args, **method_kwargs)
        return [result] * len(list(self._get_indices(indices)))

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """Slots are never wrapped one by one."""
        return [False] * len(list(self._get_indices(indices)))
