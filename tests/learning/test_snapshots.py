"""Snapshots and copies of the environments of learning libraries, and pictures of all worlds."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import gymnasium
import numpy as np
import pytest

import irsim
from irsim.diagnostics.errors import InputError
from irsim.learning import Env, ParallelEnv, VectorEnv
from tests.learning.tasks import crowd, lidar_among_boxes

VARIED = {"randomize": {"latency": {"learners": [0, 3]}, "size": {"learners": [0.8, 1.2]}, "observed": ["size"]}}


def as_bytes(value: Any) -> Any:
    """A value of a step with arrays as bytes, so that values can be compared."""
    if isinstance(value, dict):
        return {key: as_bytes(one) for key, one in value.items()}
    if isinstance(value, (tuple, list)):
        return [as_bytes(one) for one in value]
    return value.tobytes() if isinstance(value, np.ndarray) and value.dtype != object else repr(value)


def played(env: Any, actions: list[Any]) -> list[Any]:
    """The values that steps and resets return."""
    seen = []
    for action in actions:
        step = env.step(action)
        seen.append(as_bytes(step))
        over = step[2], step[3]
        if isinstance(over[0], bool) and any(over):
            seen.append(as_bytes(env.reset()))
    seen.append(as_bytes(env.reset()))
    seen.append(as_bytes(env.step(actions[0])))
    return seen


def goes_on(env: Any, actions: list[Any]) -> None:
    env.reset(seed=4)
    for action in actions[:10]:
        env.step(action)
    base = env.unwrapped
    taken = base.snapshot()
    copies = [copy.deepcopy(env), pickle.loads(pickle.dumps(env))]
    first = played(env, actions)
    base.restore(taken)
    assert played(env, actions) == first
    for one in copies:
        assert played(one, actions) == first


@pytest.mark.parametrize("keys", [{}, VARIED], ids=["plain", "varied"])
def test_an_environment_goes_on_from_a_snapshot(keys: dict[str, Any]) -> None:
    env = Env(lidar_among_boxes(**keys))
    env.action_space.seed(0)
    goes_on(env, [env.action_space.sample() for _ in range(30)])


def test_a_wrapped_environment_goes_on() -> None:
    env = gymnasium.make("irsim/GoalLidar-v0")
    env.action_space.seed(0)
    goes_on(env, [env.action_space.sample() for _ in range(30)])


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_a_vector_environment_goes_on_from_a_snapshot(mode: str) -> None:
    env = VectorEnv(lidar_among_boxes(horizon=1.5, **VARIED), 4, autoreset_mode=mode, threads=2)
    env.action_space.seed(0)
    goes_on(env, [env.action_space.sample() for _ in range(30)])


def test_learners_of_one_world_go_on_from_a_snapshot() -> None:
    env = ParallelEnv(crowd())
    env.reset(seed=1)
    still = {agent: np.zeros(2) for agent in env.agents}
    env.step(still)
    taken = env.snapshot()
    again = pickle.loads(pickle.dumps(env))
    first = as_bytes(env.step(still))
    env.restore(taken)
    assert as_bytes(env.step(still)) == first == as_bytes(again.step(still))


def test_worlds_of_several_processes_have_no_snapshot(warm_workers: None) -> None:
    env = VectorEnv(lidar_among_boxes(), 2, workers=2)
    try:
        for attempt in (env.snapshot, lambda: pickle.dumps(env), lambda: copy.deepcopy(env)):
            with pytest.raises(InputError, match="leave out workers"):
                attempt()
    finally:
        env.close()


def test_batches_go_on_from_snapshots() -> None:
    batch = irsim.batch("templates/crowd/scenario.yaml", 3, seeds=[1, 2, 3], threads=2)
    batch.advance(10)
    taken, again = batch.snapshot(), copy.deepcopy(batch)
    batch.advance(20)
    batch.reset([True, False, True])
    batch.advance(5)
    last = batch.pose.tobytes()
    for one in (batch, again, pickle.loads(pickle.dumps(again))):
        one.restore(taken)
        one.advance(20)
        one.reset([True, False, True])
        one.advance(5)
        assert one.pose.tobytes() == last
    with pytest.raises(InputError, match="other objects"):
        irsim.batch("templates/crowd/scenario.yaml", 2).restore(taken)


def test_a_vector_environment_draws_each_world() -> None:
    env = VectorEnv(lidar_among_boxes(), 3, render_mode="rgb_array")
    env.reset(seed=[0, 1, 0])
    first, second, third = env.render()
    assert first.shape == second.shape
    assert (first == third).all()
    assert (first != second).any()
    env.close()
