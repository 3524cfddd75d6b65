"""Environments of Gymnasium: its own checker, and vector forms that equal single environments."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.wrappers import NormalizeObservation, RecordEpisodeStatistics
from gymnasium.wrappers import vector as vector_wrappers

import irsim.learning
from irsim.diagnostics.errors import ArgumentError
from irsim.learning import Env, VectorEnv
from irsim.learning.registration import environment_id
from irsim.learning.tasks.files import TASKS, TaskError
from tests.learning.tasks import crowd, lidar_among_boxes, task

CHOICES = {"choices": [[0, 0], [1, 0], [0.5, 1], [0.5, -1]]}


def actions_of(env: VectorEnv, seed: int, steps: int) -> list[Any]:
    env.action_space.seed(seed)
    return [env.action_space.sample() for _ in range(steps)]


@pytest.mark.parametrize("made", [lidar_among_boxes(), lidar_among_boxes(action=CHOICES)], ids=["controls", "choices"])
def test_the_checker_of_gymnasium_has_no_complaint(made: dict[str, Any]) -> None:
    check_env(gymnasium.make("irsim/Task-v0", task=made).unwrapped)


@pytest.mark.parametrize("name", TASKS.names())
def test_bundled_tasks_are_registered(name: str) -> None:
    assert irsim.learning.__doc__
    made = gymnasium.make_vec(environment_id(name), num_envs=irsim.learning.Worlds(TASKS.bundled(name)).learners)
    seen, _ = made.reset(seed=0)
    assert made.observation_space.contains(seen)


def test_every_task_is_an_environment() -> None:
    made = gymnasium.make("irsim/Task-v0", task=lidar_among_boxes())
    assert made.reset(seed=1)[0].shape == made.observation_space.shape


@pytest.mark.parametrize("made", [lidar_among_boxes(), lidar_among_boxes(action=CHOICES)], ids=["box", "discrete"])
@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_slots_equal_single_environments(made: dict[str, Any], mode: str) -> None:
    many, singles = VectorEnv(made, 4, autoreset_mode=mode, threads=2), [Env(made) for _ in range(4)]
    seen, _ = many.reset(seed=11)
    assert np.array_equal(seen, [one.reset(seed=11 + i)[0] for i, one in enumerate(singles)])
    ended = [False] * 4
    episodes = 0
    for actions in actions_of(many, 0, 200):
        seen, reward, terminated, truncated, info = many.step(actions)
        for i, one in enumerate(singles):
            if mode == "NextStep" and ended[i]:
                mine: tuple[Any, ...] = (one.reset()[0], 0.0, False, False)
            else:
                mine = one.step(actions[i])[:4]
            ended[i] = bool(mine[2] or mine[3])
            episodes += ended[i]
            if mode == "SameStep" and ended[i]:
                assert info["_final_obs"][i]
                assert np.array_equal(info["final_obs"][i], mine[0])
                mine = (one.reset()[0], *mine[1:])
            assert np.array_equal(seen[i], mine[0])
            assert (reward[i], terminated[i], truncated[i]) == mine[1:]
    assert episodes > 4


def test_worlds_are_reset_by_a_mask() -> None:
    env = VectorEnv(lidar_among_boxes(horizon=0.5), 3, autoreset_mode="Disabled")
    before, _ = env.reset(seed=0)
    for _ in range(5):
        seen, _, _, truncated, _ = env.step(np.zeros((3, 2)))
    assert truncated.all()
    with pytest.raises(ArgumentError, match="a world is over"):
        env.step(np.zeros((3, 2)))
    mask = np.array([False, True, True])
    after, _ = env.reset(options={"reset_mask": mask})
    assert np.array_equal(after[0], seen[0])
    assert not np.array_equal(after[1:], seen[1:])
    again, _ = env.reset(seed=[0, 1, 2], options={"reset_mask": np.ones(3, dtype=bool)})
    assert np.array_equal(again, before)
    with pytest.raises(ArgumentError, match="reset_mask"):
        env.reset(options={"reset_mask": [True]})


def test_several_learners_are_neighboring_slots() -> None:
    env = VectorEnv(crowd(3, horizon=1.0, ends={"world": "all"}), 6)
    env.reset(seed=0)
    dones = np.zeros(6, dtype=int)
    for actions in actions_of(env, 3, 10):
        _, _, terminated, truncated, info = env.step(actions)
        dones += terminated | truncated
        assert info["active"].shape == (6,)
    assert (dones >= 1).all()
    with pytest.raises(ArgumentError, match="each world has 3 learners"):
        VectorEnv(crowd(3), 4)
    with pytest.raises(TaskError, match="3 learners"):
        Env(crowd(3))


def test_observations_can_share_their_memory() -> None:
    env = VectorEnv(lidar_among_boxes(), 2, copy=False)
    first, _ = env.reset(seed=0)
    second = env.step(np.ones((2, 2)))[0]
    assert np.shares_memory(first, second)
    other = VectorEnv(lidar_among_boxes(), 2)
    assert not np.shares_memory(other.reset(seed=0)[0], other.step(np.ones((2, 2)))[0])


def test_wrappers_of_gymnasium_work() -> None:
    env = NormalizeObservation(RecordEpisodeStatistics(Env(task(horizon=0.5))))
    env.reset(seed=0)
    info: dict[str, Any] = {}
    for _ in range(5):
        *_, info = env.step(np.array([1.0, 0.0]))
    assert info["episode"]["l"] == 5
    assert info["episode"]["r"] == pytest.approx(0.5)
    many = vector_wrappers.RecordEpisodeStatistics(VectorEnv(task(horizon=0.5), 2))
    many.reset(seed=0)
    for _ in range(5):
        *_, info = many.step(np.array([[1.0, 0.0], [0.5, 0.0]]))
    assert info["episode"]["l"].tolist() == [5, 5]
    assert info["episode"]["r"].tolist() == pytest.approx([0.5, 0.25])


def test_pictures_show_the_present_state() -> None:
    env = Env(task(), render_mode="rgb_array")
    env.reset(seed=0)
    first = env.render()
    for _ in range(10):
        env.step(np.array([1.0, 0.0]))
    second = env.render()
    assert first.shape == second.shape
    assert first.dtype == np.uint8
    assert first.shape[2] == 3
    assert not np.array_equal(first, second)
    assert env.metadata["render_fps"] == 10
    assert len(VectorEnv(task(), 2, render_mode="rgb_array").render() or ()) == 1
    with pytest.raises(ArgumentError, match="render_mode"):
        Env(task(), render_mode="ansi")
