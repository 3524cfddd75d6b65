"""How often learners succeed: whole episodes on given seeds, with decisions that leave nothing to chance."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.learning.tasks.files import TaskSource, open_task
from irsim.learning.worlds import Worlds

__all__ = ["Round", "Success", "measure_success"]


Decide = Callable[[NDArray[np.float32]], Any]


@dataclass(frozen=True)
class Success:
    """Shares of episodes.

    Attributes:
        worlds: Share of worlds in which every learner arrived without a collision.
        learners: Share of learners that arrived and did not collide.
        collided: Share of learners that collided.
        reward: Mean of the sums of rewards of the learners.
        time: Mean simulated time of the worlds [s].
    """

    worlds: float
    learners: float
    collided: float
    reward: float
    time: float


def measure_success(task: TaskSource, decide: Decide, *, seed: int, count: int, threads: int = 1) -> Success:
    """Run the first episode of each seed, at the last level of a curriculum.

    Args:
        task: The task.
        decide: Returns actions (B, C), or numbers of choices (B,), for observations (B, D).
        seed: First seed.
        count: Number of seeds.
        threads: Number of threads.
    """
    opened, _ = open_task(task)
    worlds = Worlds(task, count, seed=seed, threads=threads, level=len(opened.levels) - 1)
    there = worlds.present  # learners that take part in these episodes
    shape = (worlds.n, worlds.learners)
    arrived, collided = np.zeros(shape, dtype=bool), np.zeros(shape, dtype=bool)
    reward, seconds = np.zeros(shape), np.zeros(worlds.n)
    step_time = float(worlds.scenario.world.step_time)
    going = np.ones(worlds.n, dtype=bool)
    while going.any():
        result = worlds.step(decide(worlds.observe()))
        arrived |= result.arrived & going[:, None]
        collided |= result.collided & going[:, None]
        reward += result.reward * going[:, None]
        seconds += step_time * going
        going &= ~result.over
    good = arrived & ~collided
    return Success(
        worlds=float((good | ~there).all(axis=1).mean()),
        learners=float(good[there].mean()),
        collided=float(collided[there].mean()),
        reward=float(reward[there].mean()),
        time=float(seconds.mean()),
    )


@dataclass(frozen=True)
class Round:
    """A finished round.

    Attributes:
        number: Its number, from 1.
        steps: Decisions of all learners so far, without decisions of learners that waited.
        seconds: Wall-clock time of all rounds so far [s].
        success: Success of the policy on the validation seeds.
        best: Whether it is better than every earlier round: in success or, with equal success, in reward.
        rounds: Number of rounds of the whole training.
    """

    number: int
    steps: int
    seconds: float
    success: Success
    best: bool
    rounds: int
