"""Many worlds as one vector environment of Gymnasium."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.arguments import as_given, check_whole_number
from irsim.common.extras import require
from irsim.common.keywords import answers_misspelt
from irsim.diagnostics.errors import ArgumentError
from irsim.learning.gym_env import (
    RENDER_MODES,
    RESET_FIX,
    action_space,
    check_render_mode,
    frames_per_second,
    observation_space,
)
from irsim.learning.pictures import Camera
from irsim.learning.snapshots import Snapshots
from irsim.learning.step import Result
from irsim.learning.tasks.files import TaskSource
from irsim.learning.workers.divided import open_slots
from irsim.learning.worlds import Autoreset

require("gym", "gymnasium")
from gymnasium.error import ResetNeeded
from gymnasium.vector import AutoresetMode
from gymnasium.vector import VectorEnv as GymnasiumVectorEnv
from gymnasium.vector.utils import batch_space

__all__ = ["VectorEnv"]

Flags = NDArray[np.bool_]
_RESETS: dict[AutoresetMode, Autoreset | None] = {
    AutoresetMode.NEXT_STEP: "before",
    AutoresetMode.SAME_STEP: "over",
    AutoresetMode.DISABLED: None,
}


class VectorEnv(Snapshots, GymnasiumVectorEnv[NDArray[np.float32], Any, NDArray[Any]]):  # type: ignore[misc] # as in gym_env
    """``num_envs`` learners; a world's learners have neighboring slots, so n worlds with A learners make n * A slots.

    With one learner in each world, slot i is bit for bit what :class:`irsim.learning.Env` is with its seed. With more,
    the episode of a learner may be over before its world's. Its slot then waits: the reward is 0,
    ``info["active"]`` is False, and the flag ``truncated`` says in which step the world is over, too.
    ``info["contacts_between_steps"]`` has the number of contacts of each slot's episode so far that began and ended
    within one step, in the last step of an episode the number of the whole episode.

    Args:
        task: The task: its file, its data, or a task that was read.
        num_envs: Number of slots; a multiple of the number of learners in a world.
        autoreset_mode: ``NextStep``: the step after the last one of an episode starts the next and ignores the action;
            ``SameStep``: the last step does, and ``info["final_obs"]`` has what was observed before; ``Disabled``: call
            ``reset(options={"reset_mask": mask})``.
        seed: Seed of the first world, the next one has the next number; None: ``seeds.train`` of the task.
        threads: Number of threads of all processes together; results do not depend on it.
        workers: Number of processes that the worlds are divided among, this one included; results do not depend on it.
            Reward functions in Python get the worlds of their process.
        copy: Whether each step returns new arrays of observations, instead of one that the next step overwrites.
        render_mode: ``rgb_array``: :meth:`render` returns a picture of each world; ``human`` shows the first one.

    Attributes:
        worlds: The worlds behind it.

    Raises:
        TaskError: The task is not valid, or does not fit its scenario.
        ScenarioError: The scenario cannot be used.
        ArgumentError: ``num_envs`` is not a multiple of the number of learners, or there is no such number of workers.
    """

    metadata = {"render_modes": list(RENDER_MODES), "render_fps": 10, "autoreset_mode": AutoresetMode.NEXT_STEP}

    _cameras: Sequence[Camera] = ()  # closed even if the arguments are refused

    @answers_misspelt
    def __init__(
        self,
        task: TaskSource,
        num_envs: int = 1,
        *,
        autoreset_mode: str | AutoresetMode = AutoresetMode.NEXT_STEP,
        seed: int | None = None,
        threads: int = 1,
        workers: int = 1,
        copy: bool = True,
        render_mode: str | None = None,
    ) -> None:
        check_render_mode(render_mode)
        slots = check_whole_number("num_envs", num_envs, 1)
        self.worlds = open_slots(task, slots, seed=seed, threads=threads, workers=workers)
        self.num_envs = num_envs
        self.render_mode = render_mode
        self._mode = _mode(autoreset_mode)
        fps = frames_per_second(self.worlds)
        self.metadata = {**self.metadata, "render_fps": fps, "autoreset_mode": self._mode}
        self.single_observation_space = observation_space(self.worlds)
        self.single_action_space = action_space(self.worlds)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._observed = self.worlds.buffer()
        self._copy = copy
        self._over = np.zeros(self.worlds.n, dtype=bool)
        self._fresh = True
        self._told: dict[str, NDArray[Any]] | None = None
        self._facts: dict[str, Any] = {}

    def reset(
        self, *, seed: int | Sequence[int] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Start episodes.

        Args:
            seed: Seed of the first world, the next one has the next number; or one seed for each world. They start with
                the first scene of their seed. None: the next scene.
            options: ``reset_mask``: (num_envs,) bool; only worlds of slots that are True start an episode. ``level``:
                level of the curriculum, from now on.

        Raises:
            ArgumentError: The seeds are not num_envs, the mask has the wrong shape, or the level does not exist.
        """
        super().reset(seed=seed if isinstance(seed, int) else None)
        mask = self._mask((options or {}).get("reset_mask"))
        level = (options or {}).get("level")
        if level is not None:
            self.worlds.set_level(level)
            seed = self.worlds.seeds if self._fresh and seed is None else seed
        if seed is not None:
            seeds = [seed + i for i in range(self.worlds.n)] if isinstance(seed, int) else list(seed)
            if len(seeds) != self.worlds.n:
                raise ArgumentError(f"{len(seeds)} seeds are given for {self.worlds.n} worlds", "give one for each")
            self.worlds.reset(mask, seeds=seeds)
        elif not self._fresh or mask is not None:
            self.worlds.reset(mask)
        self._fresh = False
        self._over[slice(None) if mask is None else mask] = False
        seen = self.worlds.observe(self._observed)
        return seen.copy() if self._copy else seen, self._drawn()

    def set_level(self, level: int) -> None:
        """Set the level of the curriculum of the episodes that start from now on."""
        self.worlds.set_level(level)

    def step(self, actions: Any) -> tuple[NDArray[np.float32], NDArray[np.float64], Flags, Flags, dict[str, Any]]:
        """Advance all worlds by one period.

        Raises:
            ArgumentError: The actions have another shape, or are not finite.
            ResetNeeded: No episode has begun; or a world is over, and ``autoreset_mode`` is ``Disabled``.
        """
        worlds, before = self.worlds, self._over
        if self._fresh:
            raise ResetNeeded(f"no episode has begun; {RESET_FIX}")
        if self._mode is AutoresetMode.DISABLED and before.any():
            raise ResetNeeded('a world is over; start its next episode: reset(options={"reset_mask": mask})')
        step = worlds.advance(worlds.read(actions), _RESETS[self._mode], out=self._observed)
        result, seen = step.result, step.seen
        reward, terminated, truncated = (
            result.reward.reshape(-1),
            result.terminated.reshape(-1),
            result.truncated.reshape(-1),
        )
        info = _info(result)
        over: Flags = result.over & ~before
        waiting = ~info["active"] & np.repeat(over, worlds.learners)
        truncated = truncated | waiting
        if self._mode is AutoresetMode.NEXT_STEP and before.any():  # for these worlds, the step did not count
            begun = np.repeat(before, worlds.learners)
            info["active"] |= begun & worlds.present.reshape(-1)
            info["contacts_between_steps"][begun] = 0
        if self._mode is AutoresetMode.SAME_STEP and over.any():
            info |= _final(step.last, np.flatnonzero(np.repeat(over, worlds.learners)))
            over[:] = False
        self._over = over
        info |= self._drawn()
        return seen.copy() if self._copy else seen, reward, terminated, truncated, info

    def _drawn(self) -> dict[str, Any]:
        """Draws of the present episode of each slot's world, and its level; empty if nothing is drawn."""
        worlds = self.worlds
        if not worlds.varies:
            return {}
        if self._told is not worlds.drawn:  # a new episode has begun somewhere
            self._told = worlds.drawn
            arrays = {name: np.repeat(values, worlds.learners, axis=0) for name, values in worlds.drawn.items()}
            self._facts = {"drawn": arrays, "level": np.repeat(worlds.level, worlds.learners)}
        return dict(self._facts)

    def render(self) -> tuple[Any, ...] | None:
        """A picture of each world of this process. ``human`` shows the first one."""
        if self.render_mode is None:
            return None
        human = self.render_mode == "human"
        if not self._cameras:
            count = 1 if human else self.worlds.simulation.copies
            self._cameras = [Camera(self.worlds, world, human=human) for world in range(count)]
        if human:
            self._cameras[0].show()
            return None
        return tuple(camera.picture() for camera in self._cameras)

    def close_extras(self, **kwargs: Any) -> None:
        """Close the window, and end the worker processes."""
        if hasattr(self, "worlds"):  # not if the arguments were refused
            self.worlds.close()
        for camera in self._cameras:
            camera.close()

    def _mask(self, mask: Any) -> Flags | None:
        """(n,) worlds of the slots of a mask."""
        if mask is None:
            return None
        flags = np.asarray(mask)
        if flags.shape != (self.num_envs,) or flags.dtype != np.bool_ or not flags.any():
            what = f"reset_mask is {as_given(mask)}"
            raise ArgumentError(what, f"give an array of bool of shape ({self.num_envs},) with at least one True")
        return np.asarray(flags.reshape(self.worlds.n, self.worlds.learners).any(axis=1))


def _mode(given: str | AutoresetMode) -> AutoresetMode:
    try:
        return AutoresetMode(given)
    except ValueError:
        known = ", ".join(mode.value for mode in AutoresetMode)
        raise ArgumentError(f"autoreset_mode is {as_given(given)}", f"choose from {known}") from None


def _info(result: Result) -> dict[str, Any]:
    """Facts of a step as arrays of one entry for each slot."""
    arrived = result.arrived.reshape(-1)
    active = result.active.reshape(-1).copy()
    between = result.contacts_between_steps.reshape(-1)
    facts = {"arrived": arrived, "collided": result.collided.reshape(-1), "is_success": arrived, "active": active}
    return facts | {"contacts_between_steps": between}


def _final(seen: NDArray[np.float32], slots: NDArray[np.int64]) -> dict[str, Any]:
    """Last observations of an episode, as Gymnasium has them: an array of objects, and which slots have one."""
    final, there = np.full(len(seen), None, dtype=object), np.zeros(len(seen), dtype=bool)
    there[slots] = True
    for slot, row in zip(slots.tolist(), seen[slots], strict=True):
        final[slot] = row
    return {"final_obs": final, "_final_obs": there}
