"""Worlds of a task: what learners observe, what they earn, and when episodes end."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from irsim.diagnostics.errors import ArgumentError
from irsim.learning.tasks.files import TaskError
from irsim.learning.worlds import Worlds
from irsim.policies.networks.layout import Layout, layout_needs, observe
from irsim.policies.observe import Observer
from tests.learning.tasks import LIDAR, RANDOM, corridor, crowd, lidar_among_boxes, of_python, rich, task

AHEAD = np.array([[1.0, 0.0]])


def rectangle(length: float, width: float, **keys: Any) -> dict[str, Any]:
    return {"shape": {"name": "rectangle", "length": length, "width": width}, **keys}


def drive(worlds: Worlds, steps: int, seed: int = 0) -> list[tuple[Any, ...]]:
    """Random actions with resets: observations, rewards and flags of each step."""
    rng, results = np.random.default_rng(seed), []
    for _ in range(steps):
        actions = rng.uniform(-1, 1, (worlds.n, worlds.learners, worlds.width))
        actions[..., 0] = np.abs(actions[..., 0])
        results.append(one_step(worlds, actions.reshape(-1, worlds.width)))
    return results


def one_step(worlds: Worlds, actions: Any) -> tuple[Any, ...]:
    result = worlds.step(actions)
    if result.over.any():
        worlds.reset(result.over)
    return worlds.observe(), result.reward, result.terminated, result.truncated, result.over


MOTION = {"contacts": "swept", "integration": "exact"}
"""Arcs within a step, on which contacts count."""


DRAWN_LEARNERS = {"number": {"learners": [1, 4]}, "speed": {"learners": [0.5, 1]}}
MADE = {
    "crowd": crowd(),
    "swept crowd": crowd(8, world=MOTION),
    "lidar": lidar_among_boxes(),
    "everything is drawn": rich(),
    "variants": corridor(),
    "learners are drawn": crowd(randomize=DRAWN_LEARNERS),
}


@pytest.mark.parametrize("name", MADE)
def test_a_world_is_the_same_alone_and_among_others_on_any_number_of_threads(name: str) -> None:
    n = 4
    together = [Worlds(MADE[name], n, seed=7, threads=threads) for threads in (1, 3)]
    alone = [Worlds(MADE[name], 1, seed=7 + i) for i in range(n)]
    rng = np.random.default_rng(1)
    for _ in range(130):
        actions = rng.uniform(-1, 1, (n, alone[0].learners, 2))
        one, other = ((*one_step(worlds, actions.reshape(-1, 2)), worlds.simulation.pose) for worlds in together)
        assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(one, other, strict=True))
        for i, world in enumerate(alone):
            mine = (*one_step(world, actions[i]), world.simulation.pose)
            for own, every in zip(mine, one, strict=True):
                assert np.array_equal(own.ravel(), every.reshape(n, -1)[i], equal_nan=True)
            for key, values in world.drawn.items():
                assert np.array_equal(values[0], together[0].drawn[key][i])


TERMS = [
    {"name": "progress"},
    {"name": "arrival", "weight": 5, "each": True},
    {"name": "collision", "weight": -5},
    {"name": "clearance", "margin": 0.5, "to": "robots"},
    {"name": "smoothness"},
    {"name": "smoothness", "of": "turning", "weight": -0.3},
    {"name": "social", "distance": 0.7},
    {"name": "time"},
]


@pytest.mark.parametrize("action", [{}, {"returns": "velocity", "low": [-1, -1], "high": [1, 1]}], ids=["", "velocity"])
def test_one_loop_of_the_core_is_its_parts_one_after_the_other(action: dict[str, Any]) -> None:
    worlds = Worlds(crowd(reward=TERMS, action=action), 5, seed=3, threads=2)
    other = Worlds(crowd(reward=TERMS, action=action), 5, seed=3)
    third = Worlds(crowd(reward=[*TERMS, of_python("zeros")], action=action), 5, seed=3)
    rng = np.random.default_rng(2)
    for _ in range(120):
        actions = rng.uniform(-1, 1, (len(worlds.rows), worlds.width))
        step, parts = worlds.advance(worlds.read(actions), "over"), one_step(other, actions)
        result = step.result
        flags = result.reward, result.terminated, result.truncated, result.over
        assert all(np.array_equal(a, b) for a, b in zip((step.seen, *flags), parts, strict=True))
        in_python = third.advance(third.read(actions), "over")
        assert np.array_equal(step.seen, in_python.seen)
        assert np.array_equal(result.terms, in_python.result.terms[:-1])
        assert np.array_equal(result.reward, in_python.result.reward)


def test_a_seed_decides_about_all_episodes() -> None:
    worlds = Worlds(crowd(), 3, seed=9)
    drive(worlds, 20)
    worlds.reset(seeds=[4, 5, 6])
    runs = [drive(one, 150) for one in (Worlds(crowd(), 3, seed=4), Worlds(crowd(), 3, seed=4), worlds)]
    for first, again, later in zip(*runs, strict=True):
        assert all(map(np.array_equal, first, again))
        assert all(map(np.array_equal, first, later))


def test_learners_observe_what_a_network_with_the_same_layout_does() -> None:
    parts = [
        {"name": "neighbors", "count": 3, "static": True, "frame": "goal"},
        {"name": "scan", "sectors": 7},
        {"name": "own", "features": ["vx", "low", "high", "control"]},
        {"name": "map", "cells": 4, "size": 3.0},
        {"name": "goal", "features": ["x", "y", "present"]},
    ]
    robot = {"number": 3, "distribution": RANDOM, "sensors": [LIDAR]}
    box = {"number": 3, "distribution": RANDOM, **rectangle(1, 0.5)}
    worlds = Worlds(task(robot, obstacles=[box], observation=parts), 4, seed=1)
    drive(worlds, 15)
    layout = Layout.model_validate({"parts": parts})
    observer = Observer(worlds.simulation, layout_needs(layout), np.arange(3))
    first = np.zeros(len(worlds.rows), dtype=bool)
    seen = observe(layout, observer.observe(worlds.rows, first, worlds.rows // worlds.simulation.objects))
    expected = np.concatenate([seen[part["name"]].flat() for part in parts], axis=1).astype(np.float32)
    observed = worlds.observe()
    assert np.array_equal(observed, expected)
    assert (observed >= worlds.eyes.low).all()
    assert (observed <= worlds.eyes.high).all()


# rewards -------------------------------------------------------------------------------------------------------------
WALL = rectangle(1, 4, state=[1.85, 5, 0])
"""Its gap to the robot is 0.15 m."""
PERSON = {"kinematics": {"name": "omni"}, "behavior": {"name": "dash"}, "goal": [1, 9], "vel_max": [0, 0],
          "shape": {"name": "circle", "radius": 0.2}, "state": [1, 5.5, 0]}  # fmt: skip
"""One who stands 0.1 m beside the robot."""


@pytest.mark.parametrize(
    ("reward", "obstacles", "speeds", "earned"),
    [
        ({"name": "progress"}, [], (1, -1), [0.1, -0.1]),
        ({"name": "clearance", "weight": -1, "margin": 0.3}, [WALL], (0,), [-0.1 * 0.5]),
        ({"name": "social", "weight": -1, "distance": 0.2}, [WALL, PERSON], (0,), [-0.1 * 0.5]),
        ({"name": "collision", "weight": -3}, [WALL], (1, 1), [0, -3]),
    ],
    ids=["way towards the goal", "missing share of the margin per second", "only people", "a collision ends"],
)
def test_rewards_by_hand(reward: dict[str, Any], obstacles: list[Any], speeds: Any, earned: list[float]) -> None:
    worlds = Worlds(task(obstacles=obstacles, reward=[reward]))
    results = [worlds.step(speed * AHEAD) for speed in speeds]
    assert [float(one.reward[0, 0]) for one in results] == pytest.approx(earned)
    collided = reward["name"] == "collision"
    assert (results[-1].terminated.all(), results[-1].arrived.any()) == (collided, False)


def test_arrival_is_earned_once_and_ends_the_episode() -> None:
    worlds = Worlds(task({"state": [8.55, 5, 0]}, reward=[{"name": "arrival", "weight": 5}]))
    first, second, third = (worlds.step(AHEAD) for _ in range(3))
    assert [float(one.reward[0, 0]) for one in (first, second, third)] == [0, 5, 0]
    assert not first.terminated.any()
    assert (second.terminated.all(), second.over.all(), second.truncated.any()) == (True, True, False)


def test_time_and_smoothness() -> None:
    smoothness = {"name": "smoothness", "weight": -1}
    reward = [{"name": "time", "weight": -1}, smoothness, {**smoothness, "of": "turning"}]
    result = Worlds(task(reward=reward)).step(np.array([[1.0, 0.5]]))
    change, turn = (0.5**2 + 0.25**2) / 2, 1.0
    assert result.terms[:, 0, 0] == pytest.approx([-0.1, -0.1 * change, -0.1 * turn])
    assert result.reward[0, 0] == pytest.approx(result.terms.sum())


def test_a_function_of_the_user_sees_all_learners_at_once() -> None:
    worlds = Worlds(crowd(reward=[of_python("speed", weight=2)]), 3)
    result = worlds.step(np.ones((12, 2)))
    speeds = np.linalg.norm(worlds.simulation.twist[worlds.rows, :2], axis=1)
    assert np.allclose(result.reward.reshape(-1), 2 * speeds)
    wrong = Worlds(task(reward=[of_python("nothing")]))
    with pytest.raises(ArgumentError, match=r"cannot be imported"):
        wrong.step(AHEAD)


# ends ----------------------------------------------------------------------------------------------------------------
def test_the_horizon_cuts_off_and_is_no_end() -> None:
    worlds = Worlds(task(horizon=0.3))
    results = [worlds.step(AHEAD) for _ in range(3)]
    assert [bool(r.truncated[0, 0]) for r in results] == [False, False, True]
    assert not any(r.terminated.any() for r in results)


NEAR, BESIDE = {"state": [8.65, 5, 0]}, {"state": [1, 2, 0], "goal": [9, 2]}
BOTH_AHEAD = np.array([[1.0, 0.0], [1.0, 0.0]])


def test_robots_that_wait_for_others_earn_nothing() -> None:
    worlds = Worlds(task(NEAR, BESIDE, protocol="freeze", horizon=0.3))
    first, second, third = (worlds.step(BOTH_AHEAD) for _ in range(3))
    assert (first.terminated.tolist(), first.over.any()) == ([[True, False]], False)
    assert second.active.tolist() == [[False, True]]
    assert second.reward[0, 0] == 0 < second.reward[0, 1]
    assert (third.truncated.tolist(), third.over.all()) == ([[False, True]], True)


def test_robots_that_make_room_learn_until_all_have_arrived() -> None:
    worlds = Worlds(task(NEAR, {**BESIDE, "state": [8.55, 2, 0]}, protocol="yield"))
    first, second = (worlds.step(BOTH_AHEAD) for _ in range(2))
    assert (first.arrived.tolist(), first.terminated.any()) == ([[True, False]], False)
    assert (second.active.all(), second.terminated.all(), second.over.all()) == (True, True, True)


@pytest.mark.parametrize(("when", "over"), [("all", False), ("any", True), ("collision", True)])
def test_when_a_world_is_over(when: str, over: bool) -> None:
    wall = rectangle(1, 1, state=[1.75, 5, 0])
    result = Worlds(task({}, BESIDE, obstacles=[wall], ends={"world": when})).step(BOTH_AHEAD)
    assert (result.terminated.tolist(), result.truncated.tolist()) == ([[True, False]], [[False, over]])
    assert result.over.tolist() == [over]


def test_scenes_without_room_are_skipped_at_first_and_later() -> None:
    crowded = {**RANDOM, "range_low": [1, 1, -3], "range_high": [4, 7, 3], "min_distance": 0.05}
    shape = {"name": "circle", "radius": 0.8}
    worlds = Worlds(task({"number": 6, "shape": shape, "distribution": crowded}), 20, seed=0)
    for _ in range(5):
        worlds.reset(np.ones(20, dtype=bool))
    assert np.isfinite(worlds.simulation.pose).all()
    far = {"number": 2, "distribution": {**RANDOM, "goal_distance": 10.9, "min_distance": 0}}
    simulation = Worlds(task(far), 60, seed=1).simulation
    scenes = [simulation.key(k)[1] for k in range(60)]
    assert 0 < sum(scene > 0 for scene in scenes) < 60
    assert Worlds(task(far), 1, seed=7).simulation.key(0) == simulation.key(6)


# actions -------------------------------------------------------------------------------------------------------------
def control_after(action: Any, *numbers: Any, **robot: Any) -> list[float]:
    worlds = Worlds(task(robot, action=action))
    for number in numbers:
        worlds.step(np.array([number]))
    return [round(float(x), 12) for x in worlds.simulation.control[0]]


def test_numbers_lie_between_the_limits_of_the_controls() -> None:
    forward = {"vel_min": [0, -2]}
    assert control_after({}, [0.5, -0.5], **forward) == [0.75, -1.0, 0.0]
    assert control_after({}, [7.0, -9.0], **forward) == [1.0, -2.0, 0.0]
    assert control_after({"low": [0, -1], "high": [0.5, 1]}, [0.0, 1.0]) == [0.25, 1.0, 0.0]


def test_increments_add_to_the_control() -> None:
    change = {"increment": True, "low": [-0.2, -0.2], "high": [0.2, 0.2]}
    assert control_after(change, [1.0, 0.0], [1.0, 0.5]) == [0.4, 0.1, 0.0]


def test_choices_are_numbers() -> None:
    choices = {"choices": [[0, 0], [1, 0], [0.5, 1.5]]}
    assert control_after(choices, 2) == [0.5, 1.5, 0.0]
    worlds = Worlds(task(action=choices))
    for wrong in ([3], [-1], [0.5], [[0]]):
        with pytest.raises(ArgumentError, match=r"action"):
            worlds.step(np.array(wrong))


def test_velocities_are_followed_in_the_chosen_frame() -> None:
    omni = {"kinematics": {"name": "omni"}, "state": [5, 5, 0], "goal": [5, 9], "vel_max": [2, 2], "vel_min": [-2, -2]}
    assert control_after({"returns": "velocity"}, [0.5, -0.25], **omni)[:2] == [0.5, -0.25]
    assert control_after({"returns": "velocity", "frame": "goal"}, [1.0, 0.0], **omni)[:2] == [0.0, 1.0]


@pytest.mark.parametrize("wrong", [np.zeros(2), np.zeros((2, 2)), np.full((1, 2), np.nan)])
def test_wrong_actions_are_refused(wrong: Any) -> None:
    with pytest.raises(ArgumentError, match=r"action"):
        Worlds(task()).step(wrong)


# who learns ----------------------------------------------------------------------------------------------------------
def test_others_follow_their_behaviors() -> None:
    names = {"name": "ann"}, {"name": "bob", "state": [1, 2, 0], "goal": [9, 2], "behavior": {"name": "dash"}}
    worlds = Worlds(task(*names, learners=["ann"]))
    assert (worlds.names, worlds.step(0 * AHEAD).reward.shape) == (("ann",), (1, 1))
    assert worlds.simulation.twist[1, 0] > 0.5


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"observation": [{"name": "scan"}]}, r"needs the scan of a lidar, but 'ann' has no lidar"),
        ({"action": {"low": [0], "high": [1]}}, r"action.low has 1 numbers"),
        ({"action": {"choices": [[1, 2, 3]]}}, r"action.choices has 3 numbers"),
        ({"learners": ["anne"]}, r"no robot that can move has the name or the tag 'anne'. Fix: did you mean ann"),
        ({"learners": ["ann", "robot_1"]}, r"different drives"),
    ],
)
def test_tasks_that_do_not_fit_their_scenario_are_refused(keys: dict[str, Any], message: str) -> None:
    with pytest.raises(TaskError, match=message):
        Worlds(
            task({"name": "ann"}, {"kinematics": {"name": "omni"}, "state": [1, 2, 0]}, **{"learners": ["ann"], **keys})
        )


def test_without_actions_the_behaviors_of_the_scenario_drive_the_learners() -> None:
    worlds = Worlds(task({"behavior": {"name": "dash"}}, horizon=20), 2)
    arrived = np.zeros((2, 1), dtype=bool)
    while not arrived.all():
        result = worlds.step(None)
        arrived |= result.arrived
        assert result.reward[result.active].min() > 0  # progress
    assert not result.collided.any()


# RL-RVO --------------------------------------------------------------------------------------------------------------
def test_learners_observe_what_a_network_observes_and_their_last_velocity() -> None:
    worlds = Worlds("rl_rvo", 3)
    simulation, rows = worlds.simulation, worlds.rows
    observer = Observer(simulation, layout_needs(worlds.task.layout), rows % simulation.objects)
    rng = np.random.default_rng(5)
    urgent = 0
    for _ in range(40):
        before = simulation.twist[rows, :2].copy()
        actions = rng.uniform(-1, 1, (len(rows), 2))
        active = ~worlds._stepper.ended.reshape(-1)
        worlds.step(actions)
        seen = observer.observe(rows, np.zeros(len(rows), bool), rows // simulation.objects)
        assert seen.commanded is not None
        np.testing.assert_array_equal(seen.commanded[active], (before + 0.5 * actions)[active])
        parts = observe(worlds.task.layout, seen)
        flat = np.concatenate([value.flat() for value in parts.values()], axis=1).astype(np.float32)
        np.testing.assert_array_equal(worlds.observe(), flat)
        urgent += int((parts["rvo_cones"].array[:, :, 7] > 0).sum())
    assert urgent > 0


def two(*, reward: dict[str, Any], apart: float = 4.0, action: Any = None) -> Worlds:
    """Two discs of 0.2 m that face each other, each with its goal behind the other."""
    robot = {
        "kinematics": {"name": "omni"},
        "shape": {"name": "circle", "radius": 0.2},
        "vel_min": [-1, -1],
        "vel_max": [1, 1],
    }
    scene = {
        "world": {"width": 20, "height": 20, "step_time": 0.1, "collision_mode": "stop"},
        "robot": [{**robot, "state": [5, 5], "goal": [15, 5]}, {**robot, "state": [5 + apart, 5], "goal": [0, 5]}],
    }
    given = {"returns": "velocity", "low": [-1, -1], "high": [1, 1]} if action is None else action
    return Worlds({"task": "two", "scenario": scene, "observation": [{"name": "goal"}], "reward": [reward],
                   "action": given, "horizon": 5})  # fmt: skip


def test_the_reward_of_rl_rvo_by_hand() -> None:
    ahead, back = [[1.0, 0.0], [-1.0, 0.0]], [[-1.0, 0.0], [1.0, 0.0]]
    worlds = two(reward={"name": "rvo"}, apart=3.5)
    still = worlds.step(ahead).reward[0]  # velocity obstacles of two that stand: 3 m at 1 m/s
    np.testing.assert_allclose(still, 0.3 - 6 * 0.2 / 3.2, rtol=1e-6)
    moving = worlds.step(ahead).reward[0]  # 2 (1) - 1 + 1 = 2 m/s; 2.8 m are left
    np.testing.assert_allclose(moving, 0.3 - 6 * 0.2 / (1.4 + 0.2), rtol=1e-6)
    away = worlds.step(back).reward[0]
    np.testing.assert_allclose(away, 0.3 - 3 * 2 / 3, rtol=1e-6)
    far = two(reward={"name": "rvo"}, apart=4.5).step([[0.6, 0.8], [-0.6, 0.8]]).reward[0]
    np.testing.assert_allclose(far, 0.3 - 3 * np.hypot(0.4, 0.8) / 3, rtol=1e-6)
    sudden = two(reward={"name": "rvo", "weight": 0.5}, apart=0.55).step(ahead).reward[0]
    np.testing.assert_allclose(sudden, 0.5 * (0.3 - 3 * 6 * 0.2 / (0.05 + 0.2)), rtol=1e-6)


def test_controls_command_no_velocity() -> None:
    worlds = two(reward={"name": "rvo"}, apart=4.5, action={"returns": "control"})
    np.testing.assert_allclose(worlds.step([[1.0, 0.0], [-1.0, 0.0]]).reward[0], 0.3 - 3 * 1 / 3)
