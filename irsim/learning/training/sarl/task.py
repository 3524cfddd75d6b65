"""A task as a training of a value network reads it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from irsim.common.arrays import Floats
from irsim.learning.rewards.terms import Arrival, Clearance, Collision, Social
from irsim.learning.tasks.files import TaskError
from irsim.learning.tasks.task import Task
from irsim.learning.training.settings import SarlSettings
from irsim.policies.networks.layout import Layout
from irsim.policies.networks.lookahead import Lookahead
from irsim.policies.networks.parts.neighbors import NeighborsPart
from irsim.policies.networks.parts.robot import Heading
from irsim.policies.networks.sarl import joint_state_parts

__all__ = ["Plan", "plan_of"]


@dataclass(frozen=True)
class Plan:
    """How a training of a value network uses a task.

    Attributes:
        people: Number of neighbors that the network sees.
        range: Gap beyond which they are not seen [m]; None sees everyone.
        lookahead: How moves are chosen.
        heading: Meaning of the third number of a joint state.
    """

    people: int
    range: float | None
    lookahead: Lookahead

    heading: Heading

    def numbers(self, task: Task, move: Floats, held: float) -> Floats:
        """(B, 2) numbers from -1 to 1 of an action that mean these moves.

        Args:
            task: The task.
            move: (B, 2) velocities in the world frame [m/s], or speeds [m/s] and changes of the heading [rad].
            held: Time until the next decision [s].
        """
        low, high = (
            np.array(limit or [side] * 2) for limit, side in ((task.action.low, -1.0), (task.action.high, 1.0))
        )
        value = move if self.lookahead.moves.kind == "holonomic" else move / [1.0, held]
        scaled: Floats = 2.0 * (value - low) / (high - low) - 1.0
        return scaled


def plan_of(task: Task, settings: SarlSettings) -> Plan:
    """Find out what a task says.

    Raises:
        TaskError: It does not observe joint states, or its action or reward does not suit a value network.
    """
    seen = next((part for part in task.observation if isinstance(part, NeighborsPart)), None)
    people, reach = (5, None) if seen is None else (seen.count, seen.range)
    unicycle = task.action.returns == "control"
    heading: Heading = "wrapped" if unicycle else "zero"
    wanted = joint_state_parts(people, heading=heading, range=reach)
    if task.layout != Layout.model_validate({"parts": wanted}):
        what = "a value network observes joint states, which are the parts self and people"
        like = "sarl_multi_robot" if unicycle else "sarl_circle"
        raise TaskError(what, f"take the observation of the task {like}; count and range of people may differ")
    action = task.action
    fits = action.low is not None if unicycle else action.returns == "velocity" and action.frame == "world"
    if not fits or action.increment or action.choices is not None:
        what = "a value network chooses velocities in the world frame, or speeds and yaw rates between low and high"
        raise TaskError(what, "write action: {returns: velocity, frame: world, low: [-1, -1], high: [1, 1]}")
    moves: dict[str, Any] = {"speeds": settings.speeds, "headings": settings.headings}
    moves |= {"kind": "unicycle"} if unicycle else {"frame": "goal"}
    ahead = {"moves": moves, "dt": settings.dt, "gamma": settings.gamma, "reward": _reward(task, settings.gap)}
    return Plan(people, reach, Lookahead.model_validate(ahead), heading)


def _reward(task: Task, gap: str) -> dict[str, Any]:
    """The reward of the task, as the lookahead predicts it."""
    reward: dict[str, Any] = {"goal": 0.0, "collision": 0.0, "discomfort": 0.0, "gap": gap}
    for term in task.reward:
        if isinstance(term, Arrival):
            reward["goal"] = term.weight
        elif isinstance(term, Collision):
            reward["collision"] = term.weight
        elif isinstance(term, (Social, Clearance)) and reward["discomfort"] == 0.0:
            reach = term.distance if isinstance(term, Social) else term.margin
            reward |= {"discomfort": -term.weight / reach, "distance": reach}
        else:
            what = f"the reward {term.name} cannot be predicted for a move"
            raise TaskError(what, "reward arrival and collision, and one of social and clearance")
    return reward
