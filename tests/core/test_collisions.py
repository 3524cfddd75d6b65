"""Collisions in a world: broad phase, flags, modes, events."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import strategies as st

import irsim._core as core
from tests.core.worlds import apply, circle, command, line, obstacle, polygon, rectangle, robot, scene
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
