"""Environments tell contacts within a step in their info, in one process and in several."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from irsim.learning import Env, ParallelEnv, VectorEnv
from tests.learning.tasks import task

BOARD = {"name": "board", "shape": {"name": "rectangle", "length": 0.02, "width": 2}, "state": [2.05, 5, 0]}
FAST = {"shape": {"name": "circle", "radius": 0.1}, "vel_max": [3, 2], "vel_min": [-3, -2]}
AHEAD = np.array([1.0, 0.0])


def tunnel(*names: str, **world: Any) -> dict[str, Any]:
    """Robots that move 0.3 m per step; the first, on y = 5, passes through a board in its fourth step."""
    robots = [
        {**FAST, "name": name, "state": [1, 5 - 2 * k, 0], "goal": [9, 5 - 2 * k]} for k, name in enumerate(names)
    ]
    return task(*robots, obstacles=[BOARD], horizon=0.7, learners=list(names), world=world)


def test_gymnasium() -> None:
    env = Env(tunnel("ann"))
    env.reset(seed=0)
    steps = [env.step(AHEAD) for _ in range(5)]
    assert [info["contacts_between_steps"] for *_, info in steps] == [0, 0, 0, 1, 1]
    assert not any(info["collided"] or terminated for _, _, terminated, _, info in steps)
    env.reset()
    assert env.step(AHEAD)[-1]["contacts_between_steps"] == 0


def test_pettingzoo() -> None:
    env = ParallelEnv(tunnel("ann", "bob"))
    env.reset(seed=0)
    for _ in range(4):
        *_, infos = env.step({"ann": AHEAD, "bob": AHEAD})
    assert {name: info["contacts_between_steps"] for name, info in infos.items()} == {"ann": 1, "bob": 0}


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
@pytest.mark.parametrize("workers", [1, 2])
def test_vectors_have_the_number_of_the_episode_also_in_its_last_step(mode: str, workers: int) -> None:
    env = VectorEnv(tunnel("ann", "bob"), 4, autoreset_mode=mode, workers=workers)
    try:
        env.reset(seed=0)
        told = [env.step(np.tile(AHEAD, (4, 1))) for _ in range(8)]
    finally:
        env.close()
    counts = [info["contacts_between_steps"].tolist() for *_, info in told]
    assert counts[:7] == [[0, 0, 0, 0]] * 3 + [[1, 0, 1, 0]] * 4
    assert told[6][3].all()  # the last step of the episode
    assert counts[7] == [0, 0, 0, 0]


@pytest.mark.parametrize("integration", ["euler", "exact"])
def test_swept_contacts_end_episodes_and_cost_what_collisions_cost(integration: str) -> None:
    made = tunnel("ann", contacts="swept", integration=integration)
    env = Env({**made, "reward": [{"name": "collision", "weight": -5}]})
    env.reset(seed=0)
    told = [env.step(AHEAD) for _ in range(4)]
    assert [reward for _, reward, *_ in told] == [0, 0, 0, -5]
    assert [terminated for _, _, terminated, *_ in told] == [False, False, False, True]
    info = told[-1][-1]
    assert (info["collided"], info["is_success"]) == (True, False)
    x = env.worlds.simulation.state.pose[0, 0]
    assert x == pytest.approx(2.05 - 0.01 - 0.1, abs=1e-4)  # where it touches the board


@pytest.mark.parametrize("workers", [1, 2])
def test_swept_contacts_in_vectors(workers: int) -> None:
    env = VectorEnv(tunnel("ann", "bob", contacts="swept"), 4, workers=workers)
    try:
        env.reset(seed=0)
        told = [env.step(np.tile(AHEAD, (4, 1))) for _ in range(4)]
    finally:
        env.close()
    assert [info["collided"].tolist() for *_, info in told] == [[False] * 4] * 3 + [[True, False, True, False]]
