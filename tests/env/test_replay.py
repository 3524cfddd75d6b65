"""`behavior: {name: replay}` in scenarios: what follows from a recording, what others see of it, what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import irsim
import irsim._core as core
from irsim.components.behaviors.replay import Replay
from tests.core.worlds import DRIVES, robot
from tests.core.worlds import scene as core_scene
from tests.effort import examples
from tests.env.driving import Make, take_steps

TEXT = """
world: {width: 10, height: 10, step_time: 0.1, time_limit: 8}
robot:
  - {name: robot, state: [1, 5, 0], goal: [9, 5], kinematics: {name: omni}, behavior: {name: orca},
     shape: {name: circle, radius: 0.2}, sensors: [{name: lidar2d, number: 60, range_max: 20}]}
obstacle:
  - name: walker
    kinematics: {name: omni_angular}
    shape: {name: circle, radius: 0.25}
    behavior: {name: replay, times: [0.4, 1.2, 4.0], poses: [[5, 1], [5, 3], [5, 9]]}
"""


def test_start_goal_and_limits_follow_from_the_recording(make: Make) -> None:
    record = make(TEXT).obstacle_list[0].record
    assert (record.state, record.goals) == (pytest.approx([5, 1, np.pi / 2]), [[5, 9]])
    assert record.vel_min[0] <= -2.5 < 2.5 <= record.vel_max[0]
    assert (record.appear_time, record.vanish_time) == (0.4, 4.0)
    assert not irsim.validate(text=TEXT.replace("time_limit: 8", "time_limit: 30")).findings


def test_it_appears_is_seen_and_vanishes(make: Make) -> None:
    env = make(TEXT)
    walker, robot = env.obstacle_list[0], env.robot
    seen = []
    for _ in range(60):
        env.step()
        position = walker.state[:2, 0]
        seen.append(bool(np.nanmin(robot.lidar.get_scan()["ranges"]) < 19))
        if 0.4 - 1e-9 <= env.time <= 4 + 1e-9:
            expected = np.interp(env.time, [0.4, 1.2, 4.0], [1, 3, 9])
            np.testing.assert_allclose(position, [5, expected], atol=1e-9)
        else:
            assert np.isnan(position).all()
    assert seen == [4 <= step <= 40 for step in range(1, 61)]
    past = irsim.simulation.trace.past_poses(env.simulation, 1)
    assert np.isnan(past[:4, 0]).all()
    assert np.isnan(past[41:, 0]).all()
    np.testing.assert_allclose(past[[4, 12, 40], 1], [1, 3, 9])


@pytest.mark.parametrize("steps", [2, 60])
def test_the_report_misses_nobody(steps: int) -> None:
    assert "did not appear" not in irsim.run(text=TEXT, steps=steps).summary


def test_a_robot_stays_at_its_last_pose(make: Make) -> None:
    env = make("""
world: {width: 10, height: 10, step_time: 0.1, time_limit: 8}
robot:
  - {name: robot, kinematics: {name: omni}, behavior: {name: replay, times: [0.2, 1], poses: [[1, 1, 0], [2, 1, 0]]}}
""")
    take_steps(env, 20)
    np.testing.assert_allclose(env.robot.state[:2, 0], [2, 1])
    assert env.robot.arrive


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("[0.4, 1.2, 4.0]", "[0.4, 1.2]", "2 times and 3 poses"),
        ("[0.4, 1.2, 4.0]", "[0.4, 1.2, 1.2]", "times must increase"),
        ("[0.4, 1.2, 4.0]", "[-0.4, 1.2, 4.0]", "0"),
        ("[0.4, 1.2, 4.0]", "[.nan, 1.2, 4.0]", ""),
        ("[5, 3]", "[.inf, 3]", "finite"),
        ("[5, 3]", "[5]", "2"),
    ],
)
def test_recordings_that_are_none_are_refused(old: str, new: str, expected: str) -> None:
    report = irsim.validate(text=TEXT.replace(old, new))
    assert not report.valid
    assert any(expected in finding.message or expected in str(finding.allowed) for finding in report.findings)


@settings(max_examples=examples(40), deadline=None)
@given(
    gaps=st.lists(st.floats(0.05, 3), min_size=1, max_size=6),
    data=st.data(),
)
def test_limits_that_follow_never_cut_a_recording(gaps, data) -> None:
    times = np.concatenate([[0.0], np.cumsum(gaps)]).tolist()
    number = st.floats(-20, 20)
    places = data.draw(st.lists(st.lists(number, min_size=2, max_size=2), min_size=len(times), max_size=len(times)))
    options = Replay(times=times, poses=places, interpolation="cubic")
    dense = np.linspace(0, times[-1], 2000)
    kernel = core.ReplayOptions(times=times, poses=places, interpolation="cubic", vanish=False)
    world, state = core_scene(
        robot(drive=DRIVES["omni"], pose=[*places[0], 0.0], vel_max=[1e9] * 3, vel_min=[-1e9] * 3, behavior=kernel),
        step_time=float(dense[1]),
    )
    track = [np.array(state.pose[0, :2])]
    for _ in dense[1:]:
        core.advance(world, state, 1)
        track.append(np.array(state.pose[0, :2]))
    speeds = np.hypot(*np.diff(track, axis=0).T) / dense[1]
    assert speeds.max() <= options.top_speed * (1 + 1e-6) + 1e-6
