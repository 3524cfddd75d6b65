"""The record of a world: every row, and what stays the same not again."""

from __future__ import annotations

import numpy as np
import pytest

import irsim._core as core
from tests.core.test_reset import crowd
from tests.core.worlds import robot, scene

pytestmark = pytest.mark.every_python


def test_a_log_holds_what_a_rollout_returns() -> None:
    world, state = crowd([4])
    movers = list(range(0, world.objects, 2))
    log = core.Log(world, movers, 2, True)
    log.attach(state)
    start = state.pose.copy(), state.control.copy()
    log.add(state)
    trace = core.rollout(world, state, 30, returns=True)
    assert (log.first, log.rows) == (0, 31)
    np.testing.assert_array_equal(log.pose, np.concatenate([start[0][None], trace.pose])[:, movers])
    control = np.concatenate([start[1][None], trace.control])[:, movers, :2]
    np.testing.assert_array_equal(log.control, control.astype(np.float32))
    for rows, values, whole in (
        (log.goal_rows, log.goal, trace.goal),
        (log.flag_rows, log.flags, trace.arrived + 2 * trace.collided + 4 * trace.stopped),
        (log.scan_rows, log.ranges, trace.returns),
    ):
        held = np.repeat(values, np.diff([*rows, 31]), axis=0)
        np.testing.assert_array_equal(held[1:], whole)
    assert len(log.goal_rows) < 31


def test_what_was_looked_at_stays_when_the_log_goes_on() -> None:
    world, state = scene(robot(goals=[[9, 0]]))
    log = core.Log(world, [0], 2, False)
    log.attach(state)
    core.advance(world, state, 3)
    pose, goal = log.pose, log.goal
    kept = pose.copy(), goal.copy()
    core.advance(world, state, 50)
    log.clear()
    core.advance(world, state, 50)
    np.testing.assert_array_equal(pose, kept[0])
    np.testing.assert_array_equal(goal, kept[1])
    assert (log.first, log.rows) == (54, 50)
    assert log.goal_rows.tolist() == [0]


def test_a_log_ends_when_it_is_detached() -> None:
    world, state = scene(robot(goals=[[9, 0]]))
    log = core.Log(world, [0], 2, True)
    with pytest.raises(ValueError, match="not attached"):
        log.add(state)
    log.attach(state)
    core.advance(world, state, 3)
    log.detach(state)
    core.advance(world, state, 3)
    assert log.rows == 3
    assert log.ranges.shape == (0, 0)


def test_only_the_first_world_is_written_down() -> None:
    world, state = crowd([4, 5, 6])
    log = core.Log(world, [0], 2, False)
    log.attach(state)
    core.advance(world, state, 10, threads=3)
    alone_world, alone = crowd([4])
    trace = core.rollout(alone_world, alone, 10)
    np.testing.assert_array_equal(log.pose[:, 0], trace.pose[:, 0])


def test_logs_fit_their_world() -> None:
    world, state = scene(robot())
    other_world, _ = scene(robot(), robot(pose=[5, 5, 0]))
    with pytest.raises(ValueError, match="another world"):
        core.Log(other_world, [0, 1], 2, False).attach(state)
    with pytest.raises(IndexError):
        core.Log(world, [3], 2, False)
    with pytest.raises(ValueError, match="three"):
        core.Log(world, [0], 4, False)
