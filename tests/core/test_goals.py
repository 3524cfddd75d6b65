"""Arrival, waypoints, loops, wandering."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import strategies as st

import irsim._core as core
from tests.core import oracle
from tests.core.worlds import DRIVES, PI, advanced, obstacle, robot, scene
from tests.effort import for_all


@for_all(
    60,
    pose=st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-PI, PI)),
    goal=st.one_of(
        st.tuples(st.floats(-1, 1), st.floats(-1, 1)),
        st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-2 * PI, 2 * PI)),
    ),
    mode=st.sampled_from([0, 1]),
)
def test_arrival(pose, goal, mode: int) -> None:
    _, state = scene(robot(pose=pose, goals=[goal], goal_threshold=0.7, arrive_mode=mode))
    turn = oracle.wrap(pose[2] - goal[2]) if mode == 1 and len(goal) > 2 else 0.0
    distance = math.hypot(pose[0] - goal[0], pose[1] - goal[1], turn)
    if abs(distance - 0.7) > 1e-9:
        assert state.arrived[0] == (distance < 0.7)


def test_an_object_that_leaves_its_goal_has_not_arrived() -> None:
    world, state = scene(robot(goals=[[0, 0]], behavior=None))
    assert state.arrived[0] == 1
    state.command[0, 0], state.given[0] = 1.0, 1
    core.advance(world, state, 1)
    assert state.arrived[0] == 0  # exactly on the threshold is not closer than it


def test_waypoints_are_passed_in_order() -> None:
    goals = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0, 0.5]]
    state = advanced(100, robot(drive=DRIVES["omni"], goals=goals), until_done=True)
    assert state.arrived[0] == 1
    assert state.goals(0) == [[0.0, 1.0, 0.5]]
    kinds = [(kind, x, y) for kind, _, _, _, x, y in state.events(0)]
    assert [kind for kind, _, _ in kinds] == ["waypoint", "waypoint", "arrival"]
    for (_, x, y), goal in zip(kinds, goals, strict=True):
        assert math.hypot(x - goal[0], y - goal[1]) < 0.1
    assert state.event_count == 3


def test_a_goal_of_two_numbers_has_no_heading() -> None:
    _, state = scene(robot(goals=[[1, 2]]), robot(goals=[[1, 2, 3]]), robot())
    np.testing.assert_array_equal(state.goal, [[1, 2, math.nan], [1, 2, 3], [math.nan] * 3])


def test_headings_wrap_and_static_objects_arrive_too() -> None:
    turned = robot(pose=[0, 5, 3.14], goals=[[0, 5, -3.14]], arrive_mode=1)
    _, state = scene(turned, obstacle(goals=[[0, 0]]), obstacle(pose=[3, 0, 0], goals=[[0, 0]]))
    assert state.arrived.tolist() == [1, 1, 0]


def test_loop_over_waypoints() -> None:
    goals = [[1.0, 0.0], [1.0, 1.0]]
    state = advanced(200, robot(drive=DRIVES["omni"], goals=goals, loop=True))
    reached = [(round(x), round(y)) for kind, _, _, _, x, y in state.events(0)]
    assert reached[:6] == [(1, 0), (1, 1)] * 3


@pytest.mark.parametrize("mode", [0, 1])
def test_loop_over_one_goal_shuttles_between_goal_and_start(mode: int) -> None:
    goal = [2.0, 0.0, 0.0]
    state = advanced(200, robot(drive=DRIVES["omni"], goals=[goal], loop=True, arrive_mode=mode))
    reached = [round(x) for _, _, _, _, x, _ in state.events(0)]
    turns = [x for k, x in enumerate(reached) if k == 0 or x != reached[k - 1]]
    assert turns[:5] == [2, 0, 2, 0, 2]
    assert len(state.goals(0)[0]) == (3 if mode else 2)


def test_wander_draws_a_new_goal_at_each_arrival() -> None:
    options = {"wander": True, "loop": True, "range_low": [1, 2, -1], "range_high": [3, 5, 1], "goals": [[9, 9]]}
    world, state = scene(robot(pose=[2, 3, 0], drive=DRIVES["omni"], **options), seeds=[5])
    seen = [tuple(state.goal[0])]
    for _ in range(400):
        core.advance(world, state, 1)
        if tuple(state.goal[0]) != seen[-1]:
            seen.append(tuple(state.goal[0]))
    assert len(seen) > 5
    u = oracle.draws(5, 0, 0, core.STREAMS["goal"], 0, 3 * len(seen)).reshape(-1, 3)
    np.testing.assert_allclose(seen, np.array([1, 2, -1]) + u * [2, 3, 2], atol=1e-12)


def test_a_wanderer_draws_again_after_a_reset() -> None:
    _, state = scene(robot(pose=[5, 5, 0], wander=True))
    first = state.goal[0].copy()
    state.reset(np.ones(1, np.uint8), False)
    assert not np.array_equal(state.goal[0], first)


def test_set_goals() -> None:
    _, state = scene(robot(goals=[[1, 1]], behavior=None), robot(pose=[5, 5, 0], goals=[[1, 1]], behavior=None))
    state.set_goals(0, [[2, 2], [3, 3, 1]], False)
    state.set_goals(1, [[4, 4]], True)
    assert state.goal[:, :2].tolist() == [[2, 2], [4, 4]]
    assert state.goals(0) == [[2, 2], [3, 3, 1]]
    state.reset(np.ones(1, np.uint8), False)
    assert state.goal[:, :2].tolist() == [[1, 1], [4, 4]]
    state.set_goals(0, [], False)
    assert np.isnan(state.goal[0]).all()
    with pytest.raises(ValueError, match="two or three"):
        state.set_goals(0, [[1.0]], False)
    with pytest.raises(IndexError):
        state.set_goals(2, [], False)
