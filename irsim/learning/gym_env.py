"""One world with one learner as a Gymnasium environment."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.arguments import as_given
from irsim.common.extras import require
from irsim.common.keywords import answers_misspelt
from irsim.diagnostics.errors import ArgumentError
from irsim.learning.actions import as_array
from irsim.learning.pictures import Camera
from irsim.learning.snapshots import Snapshots
from irsim.learning.step import Result
from irsim.learning.tasks.files import TaskError, TaskSource
from irsim.learning.workers.divided import AnyWorlds
from irsim.learning.worlds import Worlds

require("gym", "gymnasium")
import gymnasium

__all__ = ["Env"]

RENDER_MODES = ("rgb_array", "human")
RESET_FIX = "call reset(), which starts the next one"
"""The advice to programs that step an environment without an episode."""


class Env(Snapshots, gymnasium.Env[NDArray[np.float32], Any]):  # type: ignore[misc] # types of an extra are not read
    """A task with one learner.

    The info of a step has ``arrived``, ``collided``, ``is_success``, and ``contacts_between_steps``: the number of
    contacts of the episode so far that began and ended within one step.
    ``reset(seed=s)`` starts the first scene of the seed s; each further ``reset()`` starts the next one.

    Args:
        task: The task: its file, its data, or a task that was read.
        render_mode: ``rgb_array``: :meth:`render` returns a picture; ``human``: every step shows one in a window.
        seed: Seed of the first episode if :meth:`reset` gets none; None: ``seeds.train`` of the task.

    Attributes:
        worlds: The world behind it.

    Raises:
        TaskError: The task is not valid, does not fit its scenario, or has several learners.
        ScenarioError: The scenario cannot be used.
    """

    metadata = {"render_modes": list(RENDER_MODES), "render_fps": 10}

    @answers_misspelt
    def __init__(self, task: TaskSource, *, render_mode: str | None = None, seed: int | None = None) -> None:
        check_render_mode(render_mode)
        self.worlds = Worlds(task, 1, seed=seed)
        if self.worlds.learners != 1:
            what = f"the task has {self.worlds.learners} learners, and gymnasium.Env has one"
            fix = (
                "use irsim.learning.VectorEnv or irsim.learning.ParallelEnv, or choose one robot with learners: [NAME]"
            )
            raise TaskError(what, fix)
        self.render_mode = render_mode
        self.metadata = {**self.metadata, "render_fps": frames_per_second(self.worlds)}
        self.observation_space = observation_space(self.worlds)
        self.action_space = action_space(self.worlds)
        self._camera = Camera(self.worlds, human=render_mode == "human")
        self._fresh = True
        self._over = False

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Start an episode: the first scene of ``seed``, or the next scene.

        Args:
            seed: Seed.
            options: ``level``: level of the curriculum, from now on.

        Raises:
            ArgumentError: There is no such level.
        """
        super().reset(seed=seed)
        begin(self.worlds, seed, options, fresh=self._fresh)
        self._fresh = self._over = False
        self._show()
        return self.worlds.observe()[0], drawn_facts(self.worlds)

    def set_level(self, level: int) -> None:
        """Set the level of the curriculum of the episodes that start from now on."""
        self.worlds.set_level(level)

    def step(self, action: Any) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Advance by one period.

        Raises:
            ArgumentError: The action has another shape, or is not finite.
            ResetNeeded: The episode is over, or has not begun.
        """
        if self._over or self._fresh:
            what = "no episode has begun" if self._fresh else "the episode is over"
            raise gymnasium.error.ResetNeeded(f"{what}; {RESET_FIX}")
        result = self.worlds.step(as_array(action)[None])
        self._show()
        info = facts(result, 0) | drawn_facts(self.worlds)
        terminated, truncated = bool(result.terminated[0, 0]), bool(result.truncated[0, 0])
        self._over = terminated or truncated
        return self.worlds.observe()[0], float(result.reward[0, 0]), terminated, truncated, info

    def render(self) -> Any:
        """The picture of the present state, (H, W, 3) uint8; None with ``human``, which shows it anyway."""
        return self._camera.picture() if self.render_mode == "rgb_array" else None

    def _show(self) -> None:
        if self.render_mode == "human":
            self._camera.show()

    def close(self) -> None:
        """Close the window."""
        self._camera.close()


def begin(worlds: Worlds, seed: int | None, options: dict[str, Any] | None, *, fresh: bool) -> None:
    """Start an episode in the only world of an environment.

    Args:
        worlds: The world.
        seed: Its new seed; None: the next scene.
        options: Options of the reset, such as ``level``.
        fresh: Whether the episode that the world was made with has not been used; it is, unless something changes.
    """
    level = (options or {}).get("level")
    if level is not None:
        worlds.set_level(level)
    if seed is not None or (fresh and level is not None):
        worlds.reset(seeds=worlds.seeds if seed is None else [seed])
    elif not fresh:
        worlds.reset()


def drawn_facts(worlds: Worlds) -> dict[str, Any]:
    """Draws of the episode of one world, and its level, for the info of a step; empty if nothing is drawn."""
    if not worlds.varies:
        return {}
    return {"drawn": {name: values[0] for name, values in worlds.drawn.items()}, "level": int(worlds.level[0])}


def check_render_mode(mode: str | None) -> None:
    """Refuse an unknown render mode.

    Raises:
        ArgumentError: It is unknown.
    """
    if mode is not None and mode not in RENDER_MODES:
        raise ArgumentError(f"render_mode is {as_given(mode)}", f"choose from {', '.join(RENDER_MODES)}, or None")


def frames_per_second(worlds: AnyWorlds) -> int:
    """Frames of a video in which time passes as it does in the simulation."""
    return max(1, round(1.0 / worlds.scenario.world.step_time))


def facts(result: Result, slot: int) -> dict[str, Any]:
    """Outcome of a step for one learner: whether it arrived, which is its success, and whether it collided.

    ``contacts_between_steps`` is their number in its episode so far, see :class:`irsim.learning.step.Result`.
    """
    arrived, collided = bool(result.arrived.reshape(-1)[slot]), bool(result.collided.reshape(-1)[slot])
    between = int(result.contacts_between_steps.reshape(-1)[slot])
    return {"arrived": arrived, "collided": collided, "is_success": arrived, "contacts_between_steps": between}


def observation_space(worlds: AnyWorlds) -> gymnasium.spaces.Box:
    """The box of the observations of one learner."""
    return gymnasium.spaces.Box(worlds.eyes.low, worlds.eyes.high, dtype=np.float32)


def action_space(worlds: AnyWorlds) -> gymnasium.spaces.Space[Any]:
    """The box of numbers from -1 to 1 of an action, or the numbers of the choices."""
    choices = worlds.task.action.choices
    if choices is not None:
        return gymnasium.spaces.Discrete(len(choices))
    return gymnasium.spaces.Box(-1.0, 1.0, (worlds.width,), dtype=np.float32)
