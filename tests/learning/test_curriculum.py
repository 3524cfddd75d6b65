"""Levels of a task, and the way through them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from irsim.diagnostics.errors import ArgumentError
from irsim.learning import Env, VectorEnv
from irsim.learning.ladder import Ladder
from irsim.learning.worlds import Worlds
from tests.learning.tasks import lidar_among_boxes, task

LEVELS: list[dict[str, Any]] = [
    {"randomize": {"number": {"obstacle[0]": [0, 0]}}, "horizon": 2},
    {"randomize": {"number": {"obstacle[0]": [1, 2]}}},
    {"values": {"robot[0].distribution.goal_distance": 5, "obstacle[0].shape.length": 2}},
]


def stairs(**keys: Any) -> dict[str, Any]:
    curriculum = {"levels": LEVELS, "up": 0.75, "down": 0.25, "episodes": 8, **keys}
    return lidar_among_boxes(randomize={"number": {"obstacle[0]": [3, 4]}}, curriculum=curriculum)


def test_levels_change_what_is_drawn_from_the_next_episode_on() -> None:
    worlds = Worlds(stairs(), 30, seed=2)
    numbers = []
    for level in range(3):
        worlds.set_level(level)
        before = worlds.drawn["number.obstacle[0]"]
        worlds.step(np.zeros((30, 2)))
        assert np.array_equal(worlds.drawn["number.obstacle[0]"], before)
        worlds.reset()
        assert (worlds.level == level).all()
        numbers.append(set(worlds.drawn["number.obstacle[0]"].tolist()))
    assert numbers == [{0}, {1, 2}, {3, 4}]
    start, goal = (array[worlds.rows, :2] for array in (worlds.simulation.pose, worlds.simulation.goal))
    assert np.linalg.norm(goal - start, axis=1).min() >= 5
    assert worlds.simulation.radius[1] == pytest.approx(np.hypot(1, 0.25))


def test_levels_have_their_own_horizon() -> None:
    worlds = Worlds(stairs(), 2, seed=2)
    worlds.set_level(1)
    worlds.reset(np.array([False, True]))
    assert worlds.level.tolist() == [0, 1]
    over = [worlds.step(np.zeros((2, 2))).over.tolist() for _ in range(50)]
    assert over.index([True, False]) == 19
    assert over.index([True, True]) == 49


def test_a_level_is_the_same_however_it_was_reached() -> None:
    a, b = Worlds(stairs(), 3, seed=5, level=2), Worlds(stairs(), 3, seed=9)
    b.set_level(2)
    b.reset(seeds=[5, 6, 7])
    assert np.array_equal(a.simulation.pose, b.simulation.pose, equal_nan=True)
    assert np.array_equal(a.observe(), b.observe())


def test_environments_take_levels() -> None:
    env = Env(stairs(), seed=3)
    _, info = env.reset(options={"level": 2})
    assert (info["level"], info["drawn"]["number.obstacle[0]"] >= 3) == (2, True)
    env.set_level(0)
    _, info = env.reset()
    assert (info["level"], info["drawn"]["number.obstacle[0]"]) == (0, 0)
    vector = VectorEnv(stairs(), 4, seed=3)
    _, info = vector.reset(options={"level": 1})
    assert info["level"].tolist() == [1] * 4
    _, again = VectorEnv(stairs(), 4, seed=0).reset(seed=3, options={"level": 1})
    assert np.array_equal(info["drawn"]["number.obstacle[0]"], again["drawn"]["number.obstacle[0]"])
    with pytest.raises(ArgumentError, match="give a level from 0 to 2"):
        vector.reset(options={"level": 3})
    with pytest.raises(ArgumentError, match="no curriculum"):
        Worlds(lidar_among_boxes()).set_level(1)


def play(worlds: Worlds, ladder: Ladder, succeed: bool, episodes: int) -> None:
    """Whole episodes of a robot 0.5 m before its goal, which drives or does not."""
    action = np.array([[1.0 if succeed else 0.0, 0.0]] * worlds.n)
    done = 0
    while done < episodes:
        result = worlds.step(action)
        ladder.watch(result)
        done += int(result.over.sum())
        if result.over.any():
            worlds.reset(result.over)


def near(**keys: Any) -> dict[str, Any]:
    curriculum = {"levels": [{}, {}, {}], "up": 0.75, "down": 0.25, "episodes": 8, **keys}
    return task({"state": [8.5, 5, 0]}, horizon=1, curriculum=curriculum)


def climbing(**keys: Any) -> tuple[Worlds, Ladder]:
    worlds = Worlds(near(**keys), 4)
    return worlds, Ladder(worlds, worlds.task.curriculum)


def test_successes_move_up_and_failures_down() -> None:
    worlds, ladder = climbing()
    play(worlds, ladder, True, 4)
    assert ladder.level == 0  # too few episodes
    play(worlds, ladder, True, 4)
    assert (ladder.level, worlds.level.tolist()) == (1, [1] * 4)
    for success, episodes, level in ((True, 16, 2), (False, 8, 1), (False, 20, 0)):  # 2 is the highest one
        play(worlds, ladder, success, episodes)
        assert ladder.level == level
    stubborn, ladder = climbing(down=None, start=1)
    play(stubborn, ladder, False, 20)
    assert ladder.level == 1


def test_a_ladder_goes_on_from_its_facts() -> None:
    (worlds, first), (other, second) = climbing(), climbing()
    play(worlds, first, True, 12)
    second.restore(first.facts())
    other.reset()
    assert second.facts() == first.facts() == {"level": 1, "recent": "1111"}
    play(other, second, True, 4)
    assert second.level == 2
