"""What a task says to a training of a value network."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from irsim.common.arrays import Floats
from irsim.learning.rewards.arrival import Arrival
from irsim.learning.rewards.clearance import Clearance
from irsim.learning.rewards.collision import Collision
from irsim.learning.rewards.social import Social
from irsim.learning.tasks.files import TaskError
from irsim.learning.tasks.task import Task
from irsim.learning.training.sarl.settings import SarlSettings
from irsim.policies.networks.layout import Layout
from irsim.policies.networks.lookahead import Lookahead
from irsim.policies.networks.parts.neighbors import NeighborsPart
from irsim.policies.networks.sarl import joint_state_parts

__all__ = ["Plan", "plan_of"]


@dataclass(frozen=True)
class Plan:
    """What a training of a value network does with a task.

    Attributes:
        people: Number of neighbors that the network sees.
        range: Gap beyond which they are not seen [m]; None sees everyone.
        lookahead: How moves are chosen.
    """

    people: int
    range: float | None
    lookahead: Lookahead

    def numbers(self, task: Task, velocity: Floats) -> Floats:
        """(B, 2) numbers from -1 to 1 of an action that mean these velocities [m/s], world frame."""
        low, high = (limit or [side, side] for limit, side in ((task.action.low, -1.0), (task.action.high, 1.0)))
        scaled: Floats = 2.0 * (velocity - low) / ([b - a for a, b in zip(low, high, strict=True)]) - 1.0
        return scaled


def plan_of(task: Task, settings: SarlSettings) -> Plan:
    """Find out what a task says.

    Raises:
        TaskError: It does not observe joint states, or its action or reward is not that of a value network.
    """
    seen = next((part for part in task.observation if isinstance(part, NeighborsPart)), None)
    people, reach = (5, None) if seen is None else (seen.count, seen.range)
    wanted = joint_state_parts(people, range=reach)
    if task.layout != Layout.model_validate({"parts": wanted}):
        what = "a value network observes joint states, which are the parts self and people"
        raise TaskError(what, "take the observation of the task sarl_circle; count and range of people may differ")
    action = task.action
    if action.returns != "velocity" or action.frame != "world" or action.increment or action.choices is not None:
        what = "a value network chooses velocities in the world frame"
        raise TaskError(what, "write action: {returns: velocity, frame: world, low: [-1, -1], high: [1, 1]}")
    moves = {"speeds": settings.speeds, "headings": settings.headings, "frame": "goal"}
    ahead = {"moves": moves, "dt": settings.dt, "gamma": settings.gamma, "reward": _reward(task, settings.gap)}
    return Plan(people, reach, Lookahead.model_validate(ahead))


def _reward(task: Task, gap: str) -> dict[str, Any]:
    """The reward that is predicted, which is that of the task."""
    found: dict[str, Any] = {"goal": 0.0, "collision": 0.0, "discomfort": 0.0, "gap": gap}
    for term in task.reward:
        if isinstance(term, Arrival):
            found["goal"] = term.weight
        elif isinstance(term, Collision):
            found["collision"] = term.weight
        elif isinstance(term, (Social, Clearance)) and found["discomfort"] == 0.0:
            reach = term.distance if isinstance(term, Social) else term.margin
            found |= {"discomfort": -term.weight / reach, "distance": reach}
        else:
            what = f"the reward {term.name} cannot be predicted for a move"
            raise TaskError(what, "reward arrival and collision, and one of social and clearance")
    return found
