"""Perturbations: starts, speeds and delays drawn within their spreads, for each scene, and what an overshoot is."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import strategies as st

import irsim._core as core
from tests.core import oracle
from tests.core.test_shapes import random_polygon
from tests.core.worlds import (
    DASH,
    DRIVES,
    advanced,
    apply,
    assert_identical,
    circle,
    everything,
    kernel,
    lidar,
    line,
    obstacle,
    random_placement,
    rectangle,
    robot,
    scene,
)
from tests.effort import for_all

SEEDS = st.integers(0, 2**64 - 1)
SPEEDS = {"diff": [0], "omni": [0, 1], "omni_angular": [0, 1], "steer": [0], "angular": [0]}
BEHAVIORS = {"dash": DASH, "orca": kernel("orca"), "rvo": kernel("rvo"), "sfm": kernel("sfm")}


def spread(number: int, *, speeds=(0,), attempts: int = 1000, **given: float) -> core.Perturbation:
    values = {"position": 0.0, "heading": 0.0, "speed": 0.0, "delay": 0.0, **given}
    return core.Perturbation(object=number, speeds=list(speeds), attempts=attempts, **values)


def test_draws_are_those_of_the_stream_of_perturbations() -> None:
    bodies = [robot(pose=[2, 3, 0.5]), robot(pose=[7, 6, -1.0])]
    given = [spread(i, position=0.4, heading=0.3, speed=0.2, delay=2.0) for i in range(2)]
    _, state = scene(*bodies, seeds=[9], perturbations=given)
    for i, pose in enumerate([(2, 3, 0.5), (7, 6, -1.0)]):
        u = oracle.draws(9, 0, 0, core.STREAMS["perturbation"], i, 8)
        change = (2 * u[4:7] - 1) * [0.4, 0.4, 0.3]
        np.testing.assert_allclose(state.pose[i], np.array(pose) + change, rtol=0, atol=1e-15)
        assert state.pace[i] == pytest.approx(1 + 0.2 * (2 * u[0] - 1), abs=1e-15)
        assert state.start_step[i] == math.ceil(u[1] * 2.0 / 0.1)


@for_all(
    60,
    seed=SEEDS,
    position=st.floats(0, 2),
    heading=st.floats(0, math.pi),
    speed=st.floats(0, 0.99),
    delay=st.floats(0, 9),
)
def test_spreads_are_kept(seed: int, position: float, heading: float, speed: float, delay: float) -> None:
    poses = np.array([[3.0, 3.0, 3.0], [7.0, 7.0, -0.5]])
    given = [spread(i, position=position, heading=heading, speed=speed, delay=delay) for i in range(2)]
    _, state = scene(*(robot(pose=pose) for pose in poses), seeds=[seed], perturbations=given)
    assert (np.abs(state.pose - poses)[:, :2] <= position + 1e-12).all()
    turned = (state.pose[:, 2] - poses[:, 2] + math.pi) % (2 * math.pi) - math.pi
    assert (np.abs(turned) <= heading + 1e-12).all()
    assert (np.abs(state.pose[:, 2]) <= math.pi).all()
    assert (np.abs(state.pace - 1) <= speed).all()
    assert ((state.start_step >= 0) & (state.start_step <= math.ceil(delay / 0.1))).all()


def crowd(given=(), seeds=(3,)) -> tuple[core.World, core.State]:
    """Robots with noise, one at random, one that wanders; an obstacle whose shape is drawn."""
    noisy = core.DiffOptions(noise=True, alpha=[0.03, 0.0, 0.0, 0.03], track=0.3)
    place = random_placement(objects=[1], range_low=[2, 2, -3], range_high=[8, 8, 3], min_distance=0.0, attempts=1000)
    return scene(
        robot(drive=noisy, behavior=kernel("orca"), goals=[[9, 9]], pose=[1, 1, 0], sensors=[lidar(8, noise=True)]),
        robot(drive=noisy, behavior=kernel("orca"), sensors=[lidar(8, noise=True)]),
        robot(behavior=DASH, wander=True, pose=[8, 1, 0]),
        robot(behavior=kernel("rvo"), goals=[[1, 9]], pose=[9, 1, 2]),
        obstacle(pose=[5, 5, 0.5], parts=[random_polygon()]),
        seeds=seeds,
        placements=[place],
        perturbations=given,
    )


def test_without_spread_nothing_differs() -> None:
    world, plain = crowd()
    other_world, other = crowd([spread(i) for i in range(5)])
    for _ in range(3):
        assert_identical(everything(plain), everything(other))
        core.advance(world, plain, 20)
        core.advance(other_world, other, 20)
    assert plain.events(0) == other.events(0)


def test_other_draws_stay_as_they_are() -> None:
    """Objects that are not perturbed have the same places, goals, shapes and noise as without a perturbation."""
    _, plain = crowd(seeds=range(20))
    _, other = crowd([spread(0, position=0.2, heading=1.0, speed=0.3, delay=2.0)], range(20))
    same = np.arange(len(plain.pose)) % 5 != 0
    for name in ("pose", "goal", "radius", "pace", "start_step"):
        np.testing.assert_array_equal(getattr(plain, name)[same], getattr(other, name)[same])
    assert (plain.pose[~same] != other.pose[~same]).all()
    lone_world, lone = scene(robot(drive=DRIVES["diff"], wander=True, pose=[2, 2, 0]))
    late_world, late = scene(
        robot(drive=DRIVES["diff"], wander=True, pose=[2, 2, 0]), perturbations=[spread(0, delay=5)]
    )
    assert late.start_step[0] > 0
    np.testing.assert_array_equal(lone.goal, late.goal)
    core.advance(lone_world, lone, 3)
    core.advance(late_world, late, 3)
    np.testing.assert_array_equal(lone.goal, late.goal)


@for_all(40, seed=SEEDS)
def test_nothing_overlaps_and_nothing_leaves_the_world(seed: int) -> None:
    parts = [[circle(0.3)], [rectangle(0.8, 0.4)], [rectangle(1.0, 0.2)], [circle(0.2)]]
    bodies = [robot(parts=parts[k % 4], pose=[0.6 + 0.95 * (k % 5), 0.6 + 0.95 * (k // 5), 0.0]) for k in range(20)]
    walls = [obstacle(parts=[rectangle(10, 0.2)], pose=[5, 4.6, 0]), obstacle(parts=[circle(0.4)], pose=[5.6, 1, 0])]
    given = [spread(i, position=0.5, heading=math.pi) for i in range(20)]
    _, state = scene(*bodies, *walls, seeds=[seed], perturbations=given)
    if state.failed_placement[0] >= 0:
        return
    assert state.collision_pairs(0).tolist() == []
    assert (state.pose[:20, :2] >= 0).all()


def test_what_overlaps_as_written_may_go_on_to_overlap() -> None:
    stack = [robot(parts=[rectangle(1, 1)], pose=[4 + k, 5, 0]) for k in range(3)]  # each touches the next
    apart = robot(parts=[circle(0.3)], pose=[5, 6.2, 0])
    given = [spread(i, position=0.2) for i in range(4)]
    _, state = scene(*stack, apart, seeds=range(50), perturbations=given)
    assert (state.failed_placement == -1).all()
    pairs = {tuple(pair) for w in range(50) for pair in state.collision_pairs(w).tolist()}
    assert pairs == {(0, 1), (1, 2)}


def test_nothing_starts_behind_a_wall_or_outside() -> None:
    wall, small = obstacle(parts=[line((0, 0), (0, 9))], pose=[5, 0, 0]), [circle(0.05)]
    given = [spread(1, position=1.0), spread(2, position=1.0)]
    _, state = scene(
        wall,
        robot(parts=small, pose=[4.7, 4, 0]),
        robot(parts=small, pose=[9.8, 9.9, 0]),
        seeds=range(300),
        perturbations=given,
    )
    near, corner = state.pose[1::3], state.pose[2::3]
    assert near[:, 0].max() < 4.95
    assert near[:, 0].min() < 3.8
    assert (corner[:, :2] <= 10).all()
    _, state = scene(robot(parts=small, pose=[12, 4, 0]), seeds=range(20), perturbations=[spread(0, position=1.0)])
    assert (state.failed_placement == -1).all()  # what is outside as written may stay there


def test_an_object_without_room_is_reported() -> None:
    gap = [obstacle(parts=[rectangle(9, 1)], pose=[5, 4.3, 0]), obstacle(parts=[rectangle(9, 1)], pose=[5, 5.7, 0])]
    long = robot(parts=[rectangle(3, 0.38)], pose=[5, 5, 0])
    _, state = scene(*gap, long, seeds=range(30), perturbations=[spread(2, heading=3.0, attempts=1)])
    assert set(state.failed_placement.tolist()) == {2}
    _, state = scene(*gap, long, seeds=range(30), perturbations=[spread(2, position=0.005, attempts=1)])
    assert set(state.failed_placement.tolist()) == {-1}


def test_static_objects_take_part_when_asked() -> None:
    post = obstacle(parts=[circle(0.5)], pose=[5, 5, 0])
    ray = robot(parts=[circle(0.1)], pose=[2, 5, 0], sensors=[lidar(1, angle_range=0.0)], behavior=None)
    _, still = scene(post, ray, seeds=range(9), perturbations=[spread(1, heading=1.0)])
    assert (still.pose[::2] == [5, 5, 0]).all()
    _, state = scene(post, ray, seeds=range(9), perturbations=[spread(0, position=0.4)])
    assert len({tuple(pose) for pose in state.pose[::2].tolist()}) == 9
    for w in range(9):  # sensors see it where it is
        x, y, _ = state.pose[2 * w]
        assert state.ranges[w] == pytest.approx(x - math.sqrt(0.25 - (y - 5) ** 2) - 2, abs=1e-9)


@pytest.mark.parametrize("mode", [0, 3])
@pytest.mark.parametrize("grouped", [False, True])
@pytest.mark.parametrize("name", BEHAVIORS)
@pytest.mark.parametrize("drive", DRIVES)
def test_a_delayed_object_does_the_same_later(drive: str, name: str, grouped: bool, mode: int) -> None:
    body = robot(drive=DRIVES[drive], behavior=BEHAVIORS[name], goals=[[8, 6]], pose=[2, 2, 0.5], grouped=grouped)
    world, plain = scene(body, history=True, mode=mode)
    late_world, late = scene(body, history=True, mode=mode, seeds=[4], perturbations=[spread(0, delay=4.0)])
    steps = int(late.start_step[0])
    assert 5 < steps <= 40
    core.advance(world, plain, 60)
    core.advance(late_world, late, steps)
    assert (late.trajectory(0)[:, :3] == [2, 2, 0.5]).all()
    assert (late.twist[0] == 0).all()
    core.advance(late_world, late, 60)
    np.testing.assert_array_equal(late.trajectory(0)[steps:], plain.trajectory(0))


def test_commands_do_not_move_what_waits() -> None:
    world, state = scene(
        robot(pose=[2, 2, 0], control=[0.7, 0, 0], behavior=None),
        robot(pose=[2, 5, 0], control=[0.7, 0, 0], behavior=None),
        seeds=[4],
        perturbations=[spread(0, delay=4.0)],
    )
    assert (state.control[0] == 0).all()
    assert state.control[1, 0] == 0.7
    for step in range(int(state.start_step[0]) + 1):
        assert state.pose[0, 0] == 2
        assert state.pose[1, 0] == pytest.approx(2 + 0.1 * step)
        apply(world, state, [1.0, 0.0], [1.0, 0.0])
    assert state.pose[0, 0] == pytest.approx(2.1)


def test_what_waits_can_be_pushed_and_is_seen_as_standing() -> None:
    pusher = robot(parts=[circle(0.3)], pose=[2, 5, 0], goals=[[9, 5]], mass=50.0)
    waiting = robot(parts=[circle(0.3)], pose=[3, 5, 1.5], goals=[[3, 9]], control=[1, 0, 0], friction=0.01)
    world, state = scene(pusher, waiting, mode=3, seeds=[4], perturbations=[spread(1, delay=30.0)])
    assert state.start_step[1] > 40
    assert state.velocity_world(1) == (0, 0)
    core.advance(world, state, 30)
    assert state.pose[1, 0] > 3.2


@pytest.mark.parametrize("drive", DRIVES)
def test_limits_of_speeds_change_and_those_of_turning_stay(drive: str) -> None:
    body = robot(
        drive=DRIVES[drive], behavior=None, vel_min=[-0.5, -0.6, -0.7], vel_max=[1.0, 0.8, 0.9], pose=[5, 5, 0]
    )
    given = [spread(0, speed=0.5, speeds=SPEEDS[drive])]
    for control, limits in ((9.0, (1.0, 0.8, 0.9)), (-9.0, (-0.5, -0.6, -0.7))):
        world, state = scene(body, seeds=range(8), perturbations=given)
        assert len(set(state.pace.tolist())) == 8
        apply(world, state, *[[control] * 3] * 8)
        for row in range(8):
            expected = [v * (state.pace[row] if c in SPEEDS[drive] else 1.0) for c, v in enumerate(limits)]
            used = 2 if drive in ("diff", "omni", "steer") else 3
            if drive == "angular":
                used = 2
            np.testing.assert_array_equal(state.control[row, :used], expected[:used])


@pytest.mark.parametrize(
    ("behavior", "speed"),
    [
        (DASH, 2.0),
        (kernel("orca"), 2.0),
        (kernel("orca", maxSpeed=0.8), 0.8),
        (kernel("rvo", vxmax=0.8, vymax=0.8), 0.8),
        (kernel("sfm", vmax=0.8), 0.8),
    ],
)
def test_behaviors_keep_to_their_changed_speed(behavior: object, speed: float) -> None:
    """Also where an option of the behavior, not the limit of the object, decides how fast it is."""
    drive = DRIVES["omni"]
    body = robot(
        drive=drive, behavior=behavior, goals=[[500, 5]], pose=[1, 5, 0], vel_max=[2, 2, 0], vel_min=[-2, -2, 0]
    )
    given = [spread(0, speed=0.3, speeds=[0, 1])]
    state = advanced(100, body, seeds=range(6), perturbations=given, extent=(0, 0, 600, 10))
    np.testing.assert_allclose(state.twist[:, 0], speed * state.pace, atol=0.06 if speed < 2 else 1e-9)
    if speed == 0.8:
        assert np.corrcoef(state.twist[:, 0], state.pace)[0, 1] > 0.95


def test_a_reset_repeats_the_scene_and_the_next_scene_is_another() -> None:
    one = np.ones(1, np.uint8)
    given = [spread(0, position=0.3, heading=0.4, speed=0.2, delay=3.0)]
    world, state = scene(robot(pose=[5, 5, 0], goals=[[9, 5]]), seeds=[2], perturbations=given)
    first = state.pose.copy(), state.pace.copy(), state.start_step.copy()
    core.advance(world, state, 50)
    state.reset(one, False)
    for before, now in zip(first, (state.pose, state.pace, state.start_step), strict=True):
        np.testing.assert_array_equal(before, now)
    core.advance(world, state, int(first[2][0]))
    np.testing.assert_array_equal(state.pose, first[0])  # it waits again
    state.reset(one, True)
    assert (state.pose != first[0]).all()
    assert state.pace[0] != first[1][0]


# overshoots ----------------------------------------------------------------------------------------------------------


def passing(speed: float, *, y: float = 5.0, **given: object) -> tuple[core.World, core.State]:
    """A robot that drives along y = `y` from x = 1, past a goal at (5, 5)."""
    options = {"pose": [1, y, 0], "goals": [[5, 5]], "behavior": None, "vel_max": [9, 9, 9], "history": True, **given}
    history = options.pop("history")
    world, state = scene(robot(**options), history=history)
    apply(world, state, [speed, 0.0], steps=30)
    return world, state


def test_a_goal_between_two_steps_is_reported_as_overshoot_once() -> None:
    _, state = passing(7.0)  # 1.0, 1.7, …, 4.5, 5.2: the goal is 0.2 m from the nearest
    [(kind, step, number, partner, x, y)] = state.events(0)
    assert (kind, step, number, partner) == ("overshoot", 6, 0, -1)
    assert (x, y) == pytest.approx((5.2, 5.0))


def test_what_arrives_or_passes_too_far_away_does_not_overshoot() -> None:
    _, arriving = passing(5.0)  # 1.0, 1.5, …, 5.0
    assert [event[0] for event in arriving.events(0)] == ["arrival"]
    for y, kinds in ((5.11, []), (5.09, ["overshoot"])):
        _, state = passing(7.0, y=y)
        assert [event[0] for event in state.events(0)] == kinds
    _, state = passing(7.0, arrive_mode=1, goals=[[5, 5, 0]])  # where the heading counts, passing is not a near miss
    assert state.events(0) == []


def test_every_goal_is_reported_for_itself() -> None:
    _, state = passing(7.0, goals=[[2.4, 5], [5, 5], [10.4, 5]])
    kinds = [(event[0], event[1]) for event in state.events(0)]
    assert kinds == [("waypoint", 2), ("overshoot", 6)]
    _, state = passing(7.0, goals=[[5, 5]], pose=[5.0, 5.0, 0.0])
    assert [event[0] for event in state.events(0)] == ["arrival"]  # it starts at its goal and leaves it


def test_where_a_caller_moves_objects_a_passed_goal_counts_too() -> None:
    world, state = scene(robot(pose=[1, 5, 0], goals=[[5, 5]], behavior=None))
    for x in (2.0, 4.0, 6.0, 4.0, 6.0):
        state.pose[0, 0] = x
        core.advance(world, state, 1, external=True)
    assert [(event[0], event[1]) for event in state.events(0)] == [("overshoot", 3)]
