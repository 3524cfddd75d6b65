"""Environments of Gymnasium and PettingZoo: their own checkers, vector forms, and what their infos tell."""

from __future__ import annotations

from typing import Any

import gymnasium
import matplotlib.pyplot as plt
import numpy as np
import pytest
from gymnasium.error import ResetNeeded
from gymnasium.utils.env_checker import check_env
from gymnasium.wrappers import NormalizeObservation, RecordEpisodeStatistics
from gymnasium.wrappers import vector as vector_wrappers
from pettingzoo.test import parallel_api_test, parallel_seed_test

import irsim.learning
from irsim.diagnostics.errors import ArgumentError
from irsim.learning import Env, ParallelEnv, VectorEnv
from irsim.learning.tasks.files import TASKS, TaskError, environment_id, open_task
from tests.learning.tasks import CHOICES, crowd, lidar_among_boxes, task

MADE = {"controls": lidar_among_boxes(), "choices": lidar_among_boxes(action=CHOICES)}


def actions_of(env: VectorEnv, seed: int, steps: int) -> list[Any]:
    env.action_space.seed(seed)
    return [env.action_space.sample() for _ in range(steps)]


@pytest.mark.parametrize("name", MADE)
def test_the_checker_of_gymnasium_has_no_complaint(name: str) -> None:
    plt.close("all")  # the checker opens a window, and Matplotlib warns of figures that other tests have left
    env = gymnasium.make("irsim/Task-v0", task=MADE[name])
    check_env(env.unwrapped)
    assert env.reset(seed=1)[0].shape == env.observation_space.shape


@pytest.mark.parametrize("name", TASKS.names())
def test_bundled_tasks_are_named_like_their_files_and_registered(name: str) -> None:
    made, _ = open_task(TASKS.bundled(name))
    assert (made.task, bool(made.title), bool(made.about)) == (name, True, True)
    learners = irsim.learning.Worlds(made).learners
    env = gymnasium.make_vec(environment_id(name), num_envs=2 * learners)
    seen, _ = env.reset(seed=0)
    assert (env.observation_space.contains(seen), len(seen)) == (True, 2 * learners)


@pytest.mark.parametrize("made", MADE.values(), ids=MADE)
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


@pytest.mark.parametrize("id_", ["irsim/GoalLidar-v0", None])
def test_an_episode_that_is_over_is_not_stepped(id_: str | None) -> None:
    env = Env(MADE["controls"]) if id_ is None else gymnasium.make(id_)
    env.reset(seed=0)
    while not any(env.step(env.action_space.sample())[2:4]):
        pass
    with pytest.raises(ResetNeeded, match=r"the episode is over; call reset\(\)"):
        env.step(env.action_space.sample())
    env.reset()
    env.step(env.action_space.sample())


def test_worlds_are_reset_by_a_mask() -> None:
    env = VectorEnv(lidar_among_boxes(horizon=0.5), 3, autoreset_mode="Disabled")
    before, _ = env.reset(seed=0)
    for _ in range(5):
        seen, _, _, truncated, _ = env.step(np.zeros((3, 2)))
    assert truncated.all()
    with pytest.raises(ResetNeeded, match="a world is over"):
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
    assert first.shape == second.shape == (*first.shape[:2], 3)
    assert first.dtype == np.uint8
    assert not np.array_equal(first, second)
    assert env.metadata["render_fps"] == 10
    assert len(VectorEnv(task(), 2, render_mode="rgb_array").render() or ()) == 2  # one of each world
    with pytest.raises(ArgumentError, match="render_mode"):
        Env(task(), render_mode="ansi")


# PettingZoo -----------------------------------------------------------------------------------------------------------
def test_the_tests_of_pettingzoo_pass() -> None:
    parallel_api_test(ParallelEnv(crowd(protocol="freeze")), num_cycles=300)
    parallel_seed_test(lambda: ParallelEnv(crowd()), num_cycles=50)


def test_robots_that_have_arrived_leave() -> None:
    names = {"name": "ann", "state": [8.65, 5, 0]}, {"name": "bob", "state": [8.45, 2, 0], "goal": [9, 2]}
    env = ParallelEnv(task(*names, protocol="freeze", reward=[{"name": "arrival"}]))
    env.reset(seed=0)
    ahead = np.array([1.0, 0.0])
    _, reward, terminated, truncated, info = env.step({"ann": ahead, "bob": ahead})
    assert (reward, terminated) == ({"ann": 1.0, "bob": 0.0}, {"ann": True, "bob": False})
    assert info["ann"]["is_success"]
    assert not any(truncated.values())
    assert env.agents == ["bob"]
    seen, *_ = env.step({"bob": ahead})
    assert list(seen) == ["bob"]
    env.step({"bob": ahead})
    assert env.agents == []
    with pytest.raises(ResetNeeded, match=r"call reset\(\)"):
        env.step({})
    assert env.reset()[0].keys() == {"ann", "bob"}


# contacts within steps ------------------------------------------------------------------------------------------------
BOARD = {"name": "board", "shape": {"name": "rectangle", "length": 0.02, "width": 2}, "state": [2.05, 5, 0]}
FAST = {"shape": {"name": "circle", "radius": 0.1}, "vel_max": [3, 2], "vel_min": [-3, -2]}
AHEAD = np.array([1.0, 0.0])


def tunnel(*names: str, **world: Any) -> dict[str, Any]:
    """Robots that move 0.3 m per step; the first, on y = 5, passes through a board in its fourth step."""
    robots = [
        {**FAST, "name": name, "state": [1, 5 - 2 * k, 0], "goal": [9, 5 - 2 * k]} for k, name in enumerate(names)
    ]
    return task(*robots, obstacles=[BOARD], horizon=0.7, learners=list(names), world=world)


def test_an_environment_tells_contacts_within_its_steps() -> None:
    env = Env(tunnel("ann"))
    env.reset(seed=0)
    steps = [env.step(AHEAD) for _ in range(5)]
    assert [info["contacts_between_steps"] for *_, info in steps] == [0, 0, 0, 1, 1]
    assert not any(info["collided"] or terminated for _, _, terminated, _, info in steps)
    env.reset()
    assert env.step(AHEAD)[-1]["contacts_between_steps"] == 0
    pair = ParallelEnv(tunnel("ann", "bob"))
    pair.reset(seed=0)
    for _ in range(4):
        *_, infos = pair.step({"ann": AHEAD, "bob": AHEAD})
    assert {name: info["contacts_between_steps"] for name, info in infos.items()} == {"ann": 1, "bob": 0}


def eight_steps(workers: int, mode: str = "NextStep", **world: Any) -> list[Any]:
    """The answers of a vector of two such worlds."""
    env = VectorEnv(tunnel("ann", "bob", **world), 4, autoreset_mode=mode, workers=workers)
    try:
        env.reset(seed=0)
        return [env.step(np.tile(AHEAD, (4, 1))) for _ in range(8)]
    finally:
        env.close()


@pytest.mark.usefixtures("warm_workers")
@pytest.mark.parametrize(("workers", "mode"), [(1, "NextStep"), (1, "SameStep"), (2, "NextStep"), (2, "SameStep")])
def test_vectors_have_the_number_of_the_episode_also_in_its_last_step(mode: str, workers: int) -> None:
    told = eight_steps(workers, mode)
    counts = [info["contacts_between_steps"].tolist() for *_, info in told]
    assert counts == [[0, 0, 0, 0]] * 3 + [[1, 0, 1, 0]] * 4 + [[0, 0, 0, 0]]
    assert told[6][3].all()  # the last step of the episode
    swept = eight_steps(workers, mode, contacts="swept")[:4]
    assert [info["collided"].tolist() for *_, info in swept] == [[False] * 4] * 3 + [[True, False, True, False]]


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
