"""Collisions in a world, at the ends of steps and within them: who is told, and who stops where."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import strategies as st

import irsim._core as core
from tests.core.worlds import DRIVES, PI, apply, circle, command, line, obstacle, polygon, rectangle, robot, scene
from tests.effort import for_all

SHAPES = {
    "circle": circle(0.4),
    "rectangle": rectangle(1.2, 0.5),
    "arrow": polygon((-0.6, -0.5), (0.6, 0.0), (-0.6, 0.5), (-0.2, 0.0)),
    "wall": line((-3, 0), (3, 0)),
    "large": rectangle(9, 7),
}


def all_pairs(state: core.State, shapes: list[str]) -> list[tuple[int, int]]:
    """Pairs that meet, by asking about every pair."""
    poses = state.pose.tolist()
    return [
        (i, j)
        for i in range(len(shapes))
        for j in range(i + 1, len(shapes))
        if core.intersects([SHAPES[shapes[i]]], poses[i], [SHAPES[shapes[j]]], poses[j])
    ]


@for_all(40, st.data())
def test_pairs_are_those_of_asking_about_every_pair(data: st.DataObject) -> None:
    count = data.draw(st.integers(0, 30))
    shapes = data.draw(st.lists(st.sampled_from(sorted(SHAPES)), min_size=count, max_size=count))
    static = data.draw(st.lists(st.booleans(), min_size=count, max_size=count))
    transparent = data.draw(st.lists(st.booleans(), min_size=count, max_size=count))
    spread = data.draw(st.sampled_from([3.0, 15.0, 1e4]))
    rng = np.random.default_rng(data.draw(st.integers(0, 1000)))
    poses = np.column_stack([rng.uniform(-spread, spread, (count, 2)), rng.uniform(-3, 3, count)])
    world, state = scene(
        *(
            robot(parts=[SHAPES[s]], static=still, unobstructed=through, pose=pose, behavior=None, role=int(still))
            for s, still, through, pose in zip(shapes, static, transparent, poses.tolist(), strict=True)
        ),
        mode=1,
    )
    for _ in range(4):
        pairs = all_pairs(state, shapes)
        assert [tuple(p) for p in state.collision_pairs(0).tolist()] == pairs
        hit = {i for i, j in pairs if not transparent[j]} | {j for i, j in pairs if not transparent[i]}
        assert np.flatnonzero(state.collided).tolist() == sorted(hit)
        command(state, *rng.uniform(-1, 1, (count, 2)).tolist())
        core.advance(world, state, 3)


def test_a_thousand_moving_discs() -> None:
    rng = np.random.default_rng(3)
    _, state = scene(*(robot(pose=[*p, 0.0], behavior=None) for p in rng.uniform(0, 30, (1000, 2)).tolist()), mode=1)
    for spread in (30.0, 3.0, 300.0):
        state.pose[:, :2] = rng.uniform(0, spread, (1000, 2)) * [1, 0.01 if spread == 300 else 1]
        state.refresh()
        points = shapely.points(state.pose[:, :2])
        i, j = shapely.STRtree(points).query(points, predicate="dwithin", distance=0.4)
        expected = {(a, b) for a, b in zip(i.tolist(), j.tolist(), strict=True) if a < b}
        assert {tuple(p) for p in state.collision_pairs(0).tolist()} == expected


def overlapping(mode: int, **overrides) -> core.State:
    _, state = scene(
        robot(), robot(pose=[0.3, 0, 0]), obstacle(pose=[0, 0.3, 0], **overrides), robot(pose=[9, 9, 0]), mode=mode
    )
    return state


def test_an_initial_overlap_is_seen_at_once_and_the_mode_decides_who_stops() -> None:
    stopped = {mode: overlapping(mode).stopped.tolist() for mode in (0, 1, 2)}
    assert overlapping(0).collided.tolist() == overlapping(0, unobstructed=True).collided.tolist() == [1, 1, 1, 0]
    assert stopped == {0: [1, 1, 1, 0], 1: [0, 0, 0, 0], 2: [1, 1, 0, 0]}


def test_of_two_the_flag_of_the_other_counts() -> None:
    _, state = scene(robot(), obstacle(unobstructed=True))
    assert state.collided.tolist() == [0, 1]
    assert state.collision_pairs(0).tolist() == [[0, 1]]


def test_the_mode_can_change() -> None:
    world, state = scene(robot(), robot(pose=[0.3, 0, 0]), mode=1)
    world.collision_mode = 0
    core.advance(world, state, 1)
    assert state.stopped.tolist() == [1, 1]


def test_events_tell_when_and_where_contact_begins() -> None:
    world, state = scene(robot(behavior=None), obstacle(pose=[1.05, 0, 0], parts=[rectangle(0.6, 2)]), mode=1)
    for speed in (1.0, -1.0, 1.0):
        apply(world, state, [speed], steps=8)
    events = state.events(0)
    assert [(kind, i, j) for kind, _, i, j, _, _ in events] == [("collision", 0, 1)] * 2
    assert [step for _, step, *_ in events] == [6, 22]  # 0.55 m away, 0.1 m per step; back and again
    for _, step, _, _, x, y in events:
        assert x == pytest.approx(0.775, abs=0.03), step
        assert abs(y) <= 0.2


def test_contacts_of_unobstructed_objects() -> None:
    _, state = scene(robot(unobstructed=True), robot(unobstructed=True), robot(pose=[0.1, 0, 0]))
    assert [(i, j) for _, _, i, j, _, _ in state.events(0)] == [(0, 2), (1, 2)]


@for_all(50, st.data())
def test_the_contact_point_is_in_both(data: st.DataObject) -> None:
    a, b = (data.draw(st.sampled_from(sorted(SHAPES))) for _ in range(2))
    pose = data.draw(st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-3, 3)))
    _, state = scene(robot(parts=[SHAPES[a]]), robot(parts=[SHAPES[b]], pose=pose))
    for *_, x, y in state.events(0):
        point = [core.Circle(radius=1e-9, center=[x, y])]
        assert core.intersects(point, (0, 0, 0), [SHAPES[a]], (0, 0, 0))
        assert core.intersects(point, (0, 0, 0), [SHAPES[b]], pose)


def test_a_robot_that_is_freed_goes_on() -> None:
    world, state = scene(robot(goals=[[5, 0]]), obstacle(pose=[0.3, 0, 0]))
    core.advance(world, state, 5)
    assert state.pose[0, 0] == 0.0
    state.pose[1, 0] = 0.8
    state.refresh()
    assert state.stopped.tolist() == [0, 0]
    core.advance(world, state, 2)
    assert state.pose[0, 0] == pytest.approx(0.2)


def test_refresh_moves_static_geometry_but_not_goals() -> None:
    _, state = scene(robot(goals=[[4, 4], [5, 5]]), obstacle(pose=[3, 0, 0]), seeds=[1, 2])
    state.pose[0] = [4, 4, 0]
    state.pose[3] = [4, 4, 0]
    state.pose[2] = [4, 4.1, 0]
    state.refresh()
    assert state.collided.tolist() == [0, 0, 1, 1]
    assert state.goals(0) == [[4, 4], [5, 5]]


FAST = {"vel_min": [-100.0, -100.0, -100.0], "vel_max": [100.0, 100.0, 100.0], "behavior": None}
OMNI = {**FAST, "drive": DRIVES["omni_angular"]}
BETWEEN = ("contact_between_steps", "passed_through")


def between(state: core.State, world: int = 0) -> list[tuple[str, int, int, int]]:
    """Kind, step and both objects of the contacts between steps."""
    return [(kind, step, i, j) for kind, step, i, j, _, _ in state.events(world) if kind in BETWEEN]


def moment(state: core.State) -> tuple[float, float]:
    """When the only event happened within its step, and how deep the overlap was."""
    assert len(state.events(0)) == 1
    return state.moments(0)[0]


@pytest.mark.parametrize("mode", [0, 1, 2])
def test_a_robot_that_jumps_over_another_passes_through_it(mode: int) -> None:
    world, state = scene(robot(**FAST), robot(pose=[1.0, 0.0, 0.0], behavior=None), mode=mode)
    apply(world, state, [20.0])
    assert between(state) == [("passed_through", 1, 0, 1)]
    when, depth = moment(state)
    assert when == pytest.approx(0.6 / 2.0, abs=1e-8)  # 0.6 m to the contact of a way of 2 m
    assert depth == pytest.approx(0.4, abs=1e-6)
    assert state.events(0)[0][4:] == pytest.approx((0.8, 0.0))
    assert state.between_steps.tolist() == [1, 1]
    assert state.collided.tolist() == state.stopped.tolist() == [0, 0]


def test_a_robot_that_grazes_another_comes_out_on_the_same_side() -> None:
    world, state = scene(robot(**FAST), robot(pose=[1.0, 0.3, 0.0], behavior=None))
    apply(world, state, [20.0])
    assert between(state) == [("contact_between_steps", 1, 0, 1)]
    when, depth = moment(state)
    assert when == pytest.approx((1.0 - math.sqrt(0.4**2 - 0.3**2)) / 2.0, abs=1e-8)
    assert depth == pytest.approx(0.1, abs=1e-6)


@pytest.mark.parametrize("gap", [1e-6, -1e-6])
def test_a_micrometre_decides(gap: float) -> None:
    world, state = scene(robot(**FAST), robot(pose=[1.0, 0.4 + gap, 0.0], behavior=None))
    apply(world, state, [20.0])
    assert len(between(state)) == (gap < 0.0)


def test_contacts_at_either_end_are_collisions() -> None:
    world, state = scene(robot(**FAST), robot(pose=[1.0, 0.0, 0.0], behavior=None), mode=1)
    for speed in (8.0, 20.0, -20.0):  # into the other, out of it, through it
        apply(world, state, [speed])
    assert [kind for kind, *_ in state.events(0)] == ["collision", "collision"]
    apply(world, state, [-20.0])
    assert between(state) == []


def test_unobstructed_things_have_no_contacts_between_steps() -> None:
    for first, second in ((True, False), (False, True)):
        other = robot(pose=[1.0, 0.0, 0.0], behavior=None, unobstructed=second)
        world, state = scene(robot(**FAST, unobstructed=first), other)
        apply(world, state, [20.0])
        assert state.events(0) == []
        assert not state.between_steps.any()


WALLS = {
    "rectangle": obstacle(pose=[1.0, 0.0, 0.0], parts=[rectangle(0.02, 4.0)]),
    "line": obstacle(parts=[line((1.0, -2.0), (1.0, 2.0))]),
    "bent": obstacle(parts=[polygon((0.9, -2), (1.1, -2), (1.01, 0), (1.1, 2), (0.9, 2), (0.99, 0))]),
}


@pytest.mark.parametrize("wall", ["rectangle", "line", "bent"])
def test_walls_are_passed_through(wall: str) -> None:
    world, state = scene(robot(**FAST), WALLS[wall])
    apply(world, state, [20.0])
    assert between(state) == [("passed_through", 1, 0, 1)]
    near = {"rectangle": 0.99, "line": 1.0, "bent": 0.99}[wall]
    assert moment(state)[0] == pytest.approx((near - 0.2) / 2.0, abs=0.01 if wall == "bent" else 1e-8)


def test_a_turning_bar_hits_what_it_sweeps_over() -> None:
    bar = robot(**OMNI, parts=[rectangle(2.0, 0.02)])
    world, state = scene(bar, obstacle(pose=[0.0, 0.8, 0.0], parts=[circle(0.01)]))
    apply(world, state, [0.0, 0.0, PI / 0.1 * 0.9])
    assert between(state) == [("passed_through", 1, 0, 1)]
    early = math.acos((0.01 + 0.01) / 0.8)  # angle at which the side of the bar touches the pole
    assert moment(state)[0] == pytest.approx(early / (0.9 * PI), abs=1e-6)


def test_more_than_half_a_turn_is_known_from_the_yaw_rate() -> None:
    bar = robot(**OMNI, parts=[rectangle(2.0, 0.02)])
    world, state = scene(bar, obstacle(pose=[0.0, -0.8, 0.0], parts=[circle(0.01)]))
    apply(world, state, [0.0, 0.0, PI / 0.1 * 0.4])
    assert between(state) == []
    state.reset(np.ones(1, np.uint8), False)
    apply(world, state, [0.0, 0.0, PI / 0.1 * 1.9])
    assert between(state) == [("passed_through", 1, 0, 1)]


def test_jumps_are_not_swept() -> None:
    world, state = scene(robot(**FAST), robot(pose=[1.0, 0.0, 0.0], behavior=None))
    state.pose[0, 0] = 2.0
    state.moved(0)
    core.advance(world, state, 1)
    state.pose[0, 0] = 0.0
    core.advance(world, state, 1, external=True)
    apply(world, state, [20.0])
    assert [step for _, step, *_ in between(state)] == [3]
    state.reset(np.ones(1, np.uint8), False)
    assert state.events(0) == []
    assert not state.between_steps.any()
    state.refresh()
    assert state.events(0) == []


def test_who_appears_was_not_there_before() -> None:
    world, state = scene(robot(**FAST), robot(pose=[1.0, 0.0, 0.0], behavior=None, appear_step=1))
    apply(world, state, [20.0])
    assert state.pose[1, 0] == 1.0
    assert between(state) == []


SWEPT = 1


def swept(*objects: core.ObjectSpec, **settings: Any) -> tuple[core.World, core.State]:
    world, state = scene(*objects, **settings)
    world.contacts = SWEPT
    return world, state


def kinds(state: core.State) -> list[str]:
    return [kind for kind, *_ in state.events(0)]


@pytest.mark.parametrize("wall", ["rectangle", "line"])
def test_a_robot_stops_where_it_touches_the_wall(wall: str) -> None:
    world, state = swept(robot(**FAST), WALLS[wall], history=True)
    near = {"rectangle": 0.99, "line": 1.0}[wall] - 0.2
    for step in range(4):
        apply(world, state, [20.0])
        assert state.pose[0].tolist() == pytest.approx([near, 0.0, 0.0], abs=1e-8), step
        assert state.twist[0, 0] * 0.1 == pytest.approx(0.0 if step else near, abs=1e-8), "the mean of the step"
        assert state.stopped.tolist() == state.collided.tolist() == [1, 1]
    assert kinds(state) == ["collision"]
    assert state.events(0)[0][4:] == pytest.approx((near + 0.2, 0.0), abs=1e-8)
    assert not state.between_steps.any()
    (only,) = state.trajectory(0).tolist()
    assert only[:3] == state.pose[0].tolist()


def test_both_stop_where_they_meet() -> None:
    world, state = swept(robot(**FAST), robot(**FAST, pose=[1.0, 0.0, np.pi]))
    apply(world, state, [20.0], [10.0])
    assert state.pose[:, 0] == pytest.approx([0.4, 0.8], abs=1e-8)
    assert kinds(state) == ["collision"]


def test_who_stopped_is_in_the_way_of_others() -> None:
    """The first robot stops at the wall; the second would have followed it through."""
    world, state = swept(robot(**FAST), WALLS["line"], robot(**FAST, pose=[-1.0, 0.0, 0.0]))
    apply(world, state, [20.0], [0.0], [20.0])
    assert state.pose[[0, 2], 0] == pytest.approx([0.8, 0.4], abs=1e-8)
    assert state.collision_pairs(0).tolist() == [[0, 1], [0, 2]]


def test_a_contact_that_another_one_prevents_does_not_count() -> None:
    world, state = swept(robot(**FAST), WALLS["line"], obstacle(pose=[1.5, 0.0, 0.0]))
    apply(world, state, [20.0])
    assert state.collided.tolist() == [1, 1, 0]


@pytest.mark.parametrize("mode", [1, 2, 3])
def test_other_modes(mode: int) -> None:
    world, state = swept(robot(**FAST), robot(pose=[1.0, 0.1, 0.0], behavior=None, role=1, mass=np.inf), mode=mode)
    apply(world, state, [20.0])
    if mode == 1:  # neither stops, and both are told
        assert state.pose[0, 0] == 2.0
        assert kinds(state) == ["collision", "passed_through"]
        assert state.collided.tolist() == [1, 1]
    if mode == 2:  # robots stop
        assert state.pose[0, 0] < 0.7
        assert state.stopped.tolist() == [1, 0]


def test_every_crossing_is_a_collision_of_its_own_with_its_own_time() -> None:
    world, state = swept(robot(**FAST), WALLS["line"], mode=1)
    for way in (20.0, -20.0, 20.0):
        apply(world, state, [way])
    assert kinds(state) == ["collision", "passed_through"] * 3
    first, second, third = (state.moments(0)[k][0] for k in (0, 2, 4))
    assert first == third == pytest.approx(0.4, abs=1e-8)  # 0.8 m of 2 m
    assert second == pytest.approx(0.4, abs=1e-8)


def test_a_robot_that_is_freed_within_a_step_goes_on() -> None:
    world, state = swept(robot(**FAST), robot(pose=[1.0, 0.0, 0.0], behavior=None))
    command(state, [20.0])
    core.advance(world, state, 2)
    assert state.stopped.tolist() == [1, 1]
    state.pose[1, 0] = 9.0
    core.advance(world, state, 1)
    assert state.stopped.tolist() == [0, 0]
    state.reset(np.ones(1, np.uint8), False)
    assert state.stopped.tolist() == [0, 0]


def crowd(order: int) -> tuple[core.World, core.State]:
    rng = np.random.default_rng(8)
    starts = rng.uniform(0, 4, (14, 2))
    starts = starts[[k for k in range(14) if k == 0 or min(np.hypot(*(starts[:k] - starts[k]).T)) > 0.5]]
    shapes = [circle(0.15), rectangle(0.4, 0.06)]
    objects = [
        robot(**OMNI, number=k, pose=[*place, float(rng.uniform(-3, 3))], parts=[shapes[k % 2]], extra=[])
        for k, place in enumerate(starts.tolist())
    ]
    objects.append(obstacle(number=len(objects), pose=[2.0, 2.0, 0.3], parts=[rectangle(3.0, 0.02)]))
    return swept(*objects[::order])


def drive(order: int = 1) -> core.State:
    """The state of a crowd after some steps with random controls."""
    world, state = crowd(order)
    rng = np.random.default_rng(5)
    for _ in range(6):
        apply(world, state, *rng.uniform(-8, 8, (state.pose.shape[0], 3))[::order].tolist())
    return state


def test_the_order_of_objects_does_not_matter() -> None:
    state, other = drive(), drive(-1)
    assert len(state.collision_pairs(0)) >= 3
    assert other.pose[::-1] == pytest.approx(state.pose, abs=1e-6)
    assert other.stopped[::-1].tolist() == state.stopped.tolist()


def test_nothing_passes_through_anything() -> None:
    assert not [kind for kind in kinds(drive()) if kind in BETWEEN]
