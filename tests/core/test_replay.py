"""`replay`: where a recording says, at its times, whatever is in the way; it arrives when it ends."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import strategies as st

import irsim
import irsim._core as core
from tests.core.worlds import DRIVES, PI, advanced, assert_success, circle, robot, scene
from tests.effort import for_all

STEP = 0.1  # of the scenes of tests.core.worlds [s]
FAST = [10_000.0] * 3


def replay(times, poses, interpolation: str = "linear", vanish: bool = True) -> core.ReplayOptions:
    return core.ReplayOptions(times=times, poses=poses, interpolation=interpolation, vanish=vanish)


def walker(times, poses, drive: str = "omni", interpolation: str = "linear", **keys) -> core.ObjectSpec:
    options = replay(times, poses, interpolation)
    start = [*poses[0], 0.0][:3]
    return robot(
        role=1,
        drive=DRIVES[drive],
        pose=start,
        vel_max=FAST,
        vel_min=[-v for v in FAST],
        behavior=options,
        appear_step=math.ceil(times[0] / STEP - 1e-9),
        vanish_step=1 + math.floor(times[-1] / STEP + 1e-9),
        **keys,
    )


def tracked(*objects: core.ObjectSpec, steps: int, mode: int = 0) -> np.ndarray:
    """(steps + 1, N, 3) poses."""
    world, state = scene(*objects, mode=mode)
    poses = [np.array(state.pose)]
    for _ in range(steps):
        core.advance(world, state, 1)
        poses.append(np.array(state.pose))
    return np.array(poses)


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
@pytest.mark.parametrize("drive", ["omni", "omni_angular"])
@for_all(
    40,
    first=st.integers(0, 8),
    gaps=st.lists(st.integers(1, 7), min_size=1, max_size=6),
    data=st.data(),
)
def test_recorded_places_are_met_at_their_times(drive: str, interpolation: str, first: int, gaps, data) -> None:
    steps = np.cumsum([first, *gaps])
    places = data.draw(st.lists(st.tuples(*[st.floats(-50, 50)] * 2), min_size=len(steps), max_size=len(steps)))
    track = tracked(walker((steps * STEP).tolist(), [list(p) for p in places], drive, interpolation),
                    steps=int(steps[-1]) + 3)  # fmt: skip
    np.testing.assert_allclose(track[steps, 0, :2], places, atol=1e-9)
    assert np.isnan(track[: steps[0], 0, 0]).all(), "it is absent before its first time"
    assert np.isnan(track[steps[-1] + 1 :, 0, 0]).all(), "it is absent after its last time"


def test_between_two_times_it_moves_straight_at_constant_speed() -> None:
    times, places = [0.0, 0.37, 1.25], [[0.0, 0.0], [1.0, 2.0], [-3.0, 1.0]]
    track = tracked(walker(times, places), steps=12)
    at = np.arange(13) * STEP
    expected = [np.interp(at, times, [p[axis] for p in places]) for axis in (0, 1)]
    np.testing.assert_allclose(track[:, 0, :2], np.transpose(expected), atol=1e-12)


def test_a_cubic_curve_has_no_jumps_of_speed() -> None:
    times = [0.0, 1.0, 2.0, 3.0]
    places = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [2.0, 1.0]]
    jumps = {}
    for kind in ("linear", "cubic"):
        track = tracked(walker(times, places, interpolation=kind), steps=30)[:, 0, :2]
        jumps[kind] = np.abs(np.diff(track, n=2, axis=0)).max() / STEP
    assert jumps["linear"] > 0.99
    assert jumps["cubic"] < 0.5


def test_headings_are_recorded_or_those_of_the_motion() -> None:
    given_headings = walker([0.0, 1.0], [[0.0, 0.0, 3.0], [1.0, 0.0, -3.0]], "omni_angular")
    of_motion = walker([0.0, 0.5, 1.0], [[0.0, 5.0], [0.0, 6.0], [0.0, 6.0]], "omni_angular")
    track = tracked(given_headings, of_motion, steps=10)
    turned = np.unwrap(track[:, 0, 2])
    assert turned[-1] - turned[0] == pytest.approx(2 * PI - 6.0), "the shorter way round"
    np.testing.assert_allclose(track[1:, 1, 2], PI / 2, atol=1e-9)


def test_nothing_stops_it_and_it_waits_for_no_room() -> None:
    wall = robot(role=1, drive=None, static=True, parts=[circle(0.5)], pose=[2.0, 0.0, 0.0])
    late = walker([0.5, 1.5], [[2.0, 0.0], [4.0, 0.0]])
    through = walker([0.0, 2.0], [[0.0, 0.0], [4.0, 0.0]])
    victim = robot(pose=[1.0, 0.0, 0.0], drive=DRIVES["omni"], behavior=None)
    world, state = scene(wall, late, through, victim)
    core.advance(world, state, 5)
    assert state.pose[1, 0] == pytest.approx(2.0)
    assert state.stopped[3] == 1, "what it meets stops"
    core.advance(world, state, 10)
    np.testing.assert_allclose(state.pose[1:3, 0], [4.0, 3.0])
    assert state.stopped[1] == state.stopped[2] == 0
    assert state.collided[2] == 0
    core.advance(world, state, 1)
    assert np.isnan(state.pose[1, 0])
    assert state.appeared[1] == -2 - 5
    assert (state.control[1] == 0).all()


def test_a_reset_starts_again() -> None:
    world, state = scene(walker([0.2, 0.6], [[0.0, 0.0], [1.0, 0.0]]))
    first = [core.advance(world, state, 1) and np.array(state.pose) for _ in range(9)]
    state.reset(np.ones(1, dtype=np.uint8), False)
    again = [core.advance(world, state, 1) and np.array(state.pose) for _ in range(9)]
    np.testing.assert_array_equal(first, again)


def test_batches_and_order_do_not_matter() -> None:
    walkers = [walker([0.1 * k, 1.0 + 0.1 * k], [[k, 0.0], [k, 2.0]], "omni_angular") for k in range(5)]
    forward, backward = (tracked(*chosen, steps=15) for chosen in (walkers, walkers[::-1]))
    np.testing.assert_array_equal(forward, backward[:, ::-1])


def test_other_drives_follow_as_they_can() -> None:
    way = walker([0.0, 5.0], [[0.0, 0.0], [5.0, 0.5]], "diff")
    track = tracked(way, steps=50)
    assert np.hypot(*(track[50, 0, :2] - [5.0, 0.5])) < 0.1


def test_without_a_recording_it_stands() -> None:
    state = advanced(3, robot(drive=DRIVES["omni"], behavior=replay([], [])))
    np.testing.assert_array_equal(state.pose[0], 0.0)


CROWD = """
world: {{width: 10, height: 10, step_time: 0.1, collision_mode: {mode}}}
robot:
  - {{kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.3}}, state: [5, {y}, 0], goal: [5, 5],
     behavior: {{name: dash}}, mass: 50}}
obstacle:
  - kinematics: {{name: {drive}}}
    shape: {{name: circle, radius: 0.3}}
    behavior:
      name: replay
      times: [0, 4, 6]
      poses: [[1, 5], [9, 5], [9, 8]]
  - {{name: box, shape: {{name: rectangle, length: 0.5, width: 0.5}}, state: [7, 5.1, 0], mass: 2}}
  - {{name: post, shape: {{name: circle, radius: 0.3}}, state: [9, 6.5, 0]}}
"""
LAP = """
world: {{width: 10, height: 10, step_time: 0.1}}
robot:
  - kinematics: {{name: omni}}
    shape: {{name: circle, radius: 0.2}}
    {keys}
    behavior:
      name: replay
      times: {times}
      poses: {poses}
"""
SQUARE = "[[2, 2], [8, 2], [8, 8], [2, 8], [2, 2]]"


@pytest.mark.parametrize("drive", ["omni", "omni_angular"])
def test_in_contact_mode_a_recorded_obstacle_is_where_it_was_recorded(make, drive: str) -> None:
    env = make(CROWD.format(mode="contact", drive=drive, y=5.0))
    walker, box = env.obstacle_list[0], env.obstacle_list[1]
    touched = False
    for step in range(1, 61):
        env.step()
        touched = touched or np.hypot(*(env.robot.state[:2, 0] - walker.state[:2, 0])) < 0.6 + 1e-3
        time = step * 0.1
        place = [1 + 2 * time, 5] if time <= 4 else [9, 5 + 1.5 * (time - 4)]
        np.testing.assert_allclose(walker.state[:2, 0], place, atol=1e-9)
    assert touched
    assert not walker.pushable
    assert walker.inv_mass == 0
    assert np.hypot(*(box.state[:2, 0] - (7, 5.1))) > 0.3, "what it meets is pushed by it"
    assert np.hypot(*(env.robot.state[:2, 0] - walker.state[:2, 0])) > 0.59


def test_a_recorded_obstacle_takes_who_stands_in_its_way_along(make) -> None:
    env = make(CROWD.format(mode="contact", drive="omni", y=5.0))
    for _ in range(25):
        env.step()
        gap = float(np.hypot(*(env.robot.state[:2, 0] - env.obstacle_list[0].state[:2, 0])))
        assert gap > 0.6 - 1e-3, "no robot is inside of it"


def lap(end: float = 8.0, poses: str = SQUARE, keys: str = "") -> str:
    return LAP.format(keys=keys, times=f"[0, 2, 4, 6, {end}]", poses=poses)


def test_a_robot_that_ends_where_it_began_arrives_when_its_recording_ends() -> None:
    result = irsim.run(text=lap(), seed=0)
    assert (result.outcome, result.steps, result.robots[0].path_length) == ("success", 80, pytest.approx(24.0))
    assert [(event.kind, event.time) for event in result.events] == [("arrival", pytest.approx(8.0))]


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        (lap(poses="[[2, 5], [5, 5], [8, 5], [8, 8], [5, 5]]"), 8.0),  # it passes its last place before
        (lap(7.96), 7.9),
        (lap(8.04), 8.0),
        (lap(keys="goal: [8, 8]"), 4.0),  # a goal that is written counts on the way
        (LAP.format(keys="", times="[0]", poses="[[3, 3]]"), 0.0),
        (LAP.format(keys="", times="[0, 2]", poses="[[3, 3], [3, 3]]"), 2.0),
    ],
)
def test_a_recording_arrives_at(text: str, seconds: float) -> None:
    assert assert_success(text, seed=0).robots[0].time_to_goal == pytest.approx(seconds, abs=0.11 if seconds else 0)


def test_an_obstacle_that_comes_back_is_said_to_arrive_once_and_late(make) -> None:
    text = CROWD.format(mode="stop", drive="omni", y=2.0).replace(
        "[[1, 5], [9, 5], [9, 8]]", "[[1, 5], [9, 5], [1, 5]]"
    )
    env = make(text)
    for _ in range(60):
        env.step()
    mine = [event for event in env.events if event.object == env.obstacle_list[0].name and event.kind == "arrival"]
    assert [round(event.time, 3) for event in mine] == [6.0]


def test_a_reset_replays_it_again(make) -> None:
    env = make(lap())
    for _ in range(2):
        assert not env.robot.arrive
        steps = 0
        while not env.done():
            env.step()
            steps += 1
        assert steps == 80
        env.reset()
