"""All learners of one world as a parallel environment of PettingZoo."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.extras import require
from irsim.common.keywords import answers_misspelt
from irsim.learning.actions import as_array
from irsim.learning.gym_env import (
    RENDER_MODES,
    RESET_FIX,
    action_space,
    begin,
    check_render_mode,
    drawn_facts,
    facts,
    frames_per_second,
    observation_space,
)
from irsim.learning.pictures import Camera
from irsim.learning.snapshots import Snapshots
from irsim.learning.tasks.files import TaskSource
from irsim.learning.worlds import Worlds

require("gym", "pettingzoo", "gymnasium")
import pettingzoo
from gymnasium.error import ResetNeeded

__all__ = ["ParallelEnv"]

Agent = str


class ParallelEnv(Snapshots, pettingzoo.ParallelEnv[Agent, NDArray[np.float32], Any]):  # type: ignore[misc] # as in gym_env
    """A task with any number of learners; each robot is an agent, by its name.

    An agent whose episode is over leaves ``agents`` after the step that says so; its robot stays in the world. When the
    last one leaves, or the world is over, ``agents`` is empty. Infos are as in :class:`irsim.learning.Env`.

    Args:
        task: The task: its file, its data, or a task that was read.
        render_mode: ``rgb_array``: :meth:`render` returns a picture; ``human``: every step shows one in a window.
        seed: Seed of the first episode if :meth:`reset` gets none; None: ``seeds.train`` of the task.

    Attributes:
        worlds: The world behind it.
        possible_agents: Names of the learners.
        agents: Names of those whose episodes go on.

    Raises:
        TaskError: The task is not valid, or does not fit its scenario.
        ScenarioError: The scenario cannot be used.
    """

    metadata = {"render_modes": list(RENDER_MODES), "render_fps": 10, "is_parallelizable": True}

    @answers_misspelt
    def __init__(self, task: TaskSource, *, render_mode: str | None = None, seed: int | None = None) -> None:
        check_render_mode(render_mode)
        self.worlds = Worlds(task, 1, seed=seed)
        name = f"irsim_{self.worlds.task.task}"
        self.metadata = {**self.metadata, "name": name, "render_fps": frames_per_second(self.worlds)}
        self.render_mode = render_mode
        self.possible_agents: list[Agent] = list(self.worlds.names)
        self.agents: list[Agent] = []
        self.observation_spaces = {agent: observation_space(self.worlds) for agent in self.possible_agents}
        self.action_spaces = {agent: action_space(self.worlds) for agent in self.possible_agents}
        self._slots = {agent: slot for slot, agent in enumerate(self.possible_agents)}
        self._camera = Camera(self.worlds, human=render_mode == "human")
        self._fresh = True

    def observation_space(self, agent: Agent) -> Any:
        """The box of the observations of an agent."""
        return self.observation_spaces[agent]

    def action_space(self, agent: Agent) -> Any:
        """The space of the actions of an agent."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[Agent, NDArray[np.float32]], dict[Agent, dict[str, Any]]]:
        """Start an episode: the first scene of ``seed``, or the next scene. Its agents are the robots that take part.

        Args:
            seed: Seed.
            options: ``level``: level of the curriculum, from now on.

        Raises:
            ArgumentError: There is no such level.
        """
        begin(self.worlds, seed, options, fresh=self._fresh)
        self._fresh = False
        here = self.worlds.present[0]
        self.agents = [agent for agent, slot in self._slots.items() if here[slot]]
        seen = self.worlds.observe()
        return (
            {agent: seen[self._slots[agent]] for agent in self.agents},
            {agent: drawn_facts(self.worlds) for agent in self.agents},
        )

    def set_level(self, level: int) -> None:
        """Set the level of the curriculum of the episodes that start from now on."""
        self.worlds.set_level(level)

    def step(
        self, actions: dict[Agent, Any]
    ) -> tuple[
        dict[Agent, NDArray[np.float32]],
        dict[Agent, float],
        dict[Agent, bool],
        dict[Agent, bool],
        dict[Agent, dict[str, Any]],
    ]:
        """Advance by one period.

        Args:
            actions: Action of each agent in ``agents``.

        Raises:
            KeyError: The action of an agent is missing.
            ArgumentError: An action has another shape, or is not finite.
            ResetNeeded: There are no agents: the episode is over, or has not begun.
        """
        if not self.agents:
            raise ResetNeeded(f"no episode is under way; {RESET_FIX}")
        idle = np.zeros_like(as_array(actions[self.agents[0]]))
        acting = set(self.agents)
        given = [actions[agent] if agent in acting else idle for agent in self.possible_agents]
        result = self.worlds.step(as_array([as_array(action) for action in given]))
        seen = self.worlds.observe()
        slots = {agent: self._slots[agent] for agent in self.agents}
        reward, ended, cut = (a[0].tolist() for a in (result.reward, result.terminated, result.truncated))
        self.agents = [agent for agent, slot in slots.items() if not (ended[slot] or cut[slot])]
        if self.render_mode == "human":
            self._camera.show()
        return (
            {agent: seen[slot] for agent, slot in slots.items()},
            {agent: reward[slot] for agent, slot in slots.items()},
            {agent: ended[slot] for agent, slot in slots.items()},
            {agent: cut[slot] for agent, slot in slots.items()},
            {agent: facts(result, slot) | drawn_facts(self.worlds) for agent, slot in slots.items()},
        )

    def render(self) -> Any:
        """The picture of the present state, (H, W, 3) uint8; None with ``human``, which shows it anyway."""
        return self._camera.picture() if self.render_mode == "rgb_array" else None

    def close(self) -> None:
        """Close the window."""
        self._camera.close()
