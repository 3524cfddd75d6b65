"""Zones and fields of view: who enters, leaves, crosses and is seen, at which step, against plain geometry."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import strategies as st

import irsim._core as core
from tests.core.worlds import DRIVES, advanced, circle, line, obstacle, polygon, rectangle, robot, scene
from tests.effort import for_all

STEP = 0.1
Event = tuple[str, int, int, int, float, float]


def drive(states: Sequence[Sequence[float]], *, zones: Sequence[core.Part], parts: Any = None) -> list[Event]:
    """Events of one body that is moved from state to state, one per step."""
    body = robot(drive=DRIVES["omni"], parts=parts or [circle(0.2)], behavior=None, pose=_pose(states[0]))
    world, state = scene(body, mode=1, zones=zones)
    for place in states[1:]:
        state.pose[0] = _pose(place)
        core.advance(world, state, 1, external=True)
    return state.events(0)


def _pose(place: Sequence[float]) -> list[float]:
    return [*place, 0.0][:3]


def kinds(events: Sequence[Event]) -> list[tuple[str, int]]:
    return [(kind, step) for kind, step, *_ in events]


# regions --------------------------------------------------------------------------------------------------------------
BOX = polygon((4, 0), (6, 0), (6, 2), (4, 2))


# a disc of 0.25 m touches the box with its centre from 3.75 to 6.25; these numbers have no rounding errors
VISITS = {
    "touching": (BOX, circle(0.25), [(3.5, 1), (3.75, 1), (5, 1), (6.25, 1), (6.5, 1)], [1, 4]),
    "starting inside, never leaving": (BOX, circle(0.2), [(5, 1), (5.5, 1), (5, 1.5)], [0]),
    "covering a small region": (circle(0.01, center=(5, 1)), rectangle(2, 2), [(3, 1), (5, 1), (7, 1)], [1, 2]),
}


@pytest.mark.parametrize("case", VISITS)
def test_a_body_is_inside_as_long_as_it_touches_the_region(case: str) -> None:
    zone, body, way, steps = VISITS[case]
    events = drive(way, zones=[zone], parts=[body])
    assert kinds(events) == list(zip(("zone_entry", "zone_exit"), steps, strict=False))
    assert [event[4:] for event in events] == [way[step] for step in steps]


def test_each_region_counts_on_its_own_and_events_name_its_index() -> None:
    events = drive([(0, 1), (5, 1), (9, 1)], zones=[BOX, circle(1, center=(5, 1)), circle(1, center=(9, 1))])
    assert [(event[0], event[1], event[3]) for event in events] == [
        ("zone_entry", 1, 0), ("zone_entry", 1, 1),
        ("zone_exit", 2, 0), ("zone_exit", 2, 1), ("zone_entry", 2, 2),
    ]  # fmt: skip


OUTLINES = {
    "disc": ([circle(0.3)], shapely.Point(0, 0).buffer(0.3, quad_segs=256)),
    "box": ([rectangle(0.8, 0.4)], shapely.box(-0.4, -0.2, 0.4, 0.2)),
    "line": ([line((-0.5, 0), (0.5, 0.2))], shapely.LineString([(-0.5, 0), (0.5, 0.2)])),
    "compound": (
        [rectangle(0.8, 0.2), polygon((0.2, -0.4), (0.5, -0.4), (0.5, 0.4))],
        shapely.union_all([shapely.box(-0.4, -0.1, 0.4, 0.1), shapely.Polygon([(0.2, -0.4), (0.5, -0.4), (0.5, 0.4)])]),
    ),
}
SHARP = [(4, 4), (6, 4), (6, 6), (5, 4.6), (4, 6)]
REGIONS = {
    "concave": (polygon(*SHARP), shapely.Polygon(SHARP)),
    "clockwise": (polygon(*SHARP[::-1]), shapely.Polygon(SHARP)),
    "disc": (circle(0.8, center=(5, 5)), shapely.Point(5, 5).buffer(0.8, quad_segs=256)),
}
PLACES = st.lists(st.tuples(st.floats(3, 7), st.floats(3, 7), st.floats(-3, 3)), min_size=2, max_size=12)


@pytest.mark.parametrize("body", OUTLINES)
@pytest.mark.parametrize("region", REGIONS)
@for_all(40, places=PLACES)
def test_visits_are_those_of_shapely(body: str, region: str, places: list[tuple[float, float, float]]) -> None:
    parts, outline = OUTLINES[body]
    zone, area = REGIONS[region]
    events = drive(places, zones=[zone], parts=parts)
    inside = {step: kind == "zone_entry" for kind, step, *_ in events}
    now = False
    for step, (x, y, theta) in enumerate(places):
        now = inside.get(step, now)
        turned = shapely.affinity.rotate(outline, theta, origin=(0, 0), use_radians=True)
        placed = shapely.affinity.translate(turned, x, y)
        if placed.distance(area) > 1e-3 or placed.intersection(area).area > 1e-3 or placed.within(area):
            assert now == placed.intersects(area), step


# lines ----------------------------------------------------------------------------------------------------------------
DOOR = line((5, 4), (5, 6))
RIGHT, LEFT = "crossing_to_right", "crossing_to_left"


@pytest.mark.parametrize(
    ("way", "crossings"),
    [
        ([(4, 5), (6, 5)], [(RIGHT, 1)]),
        ([(6, 5), (4, 5)], [(LEFT, 1)]),
        ([(4, 5), (6, 5), (4, 5)], [(RIGHT, 1), (LEFT, 2)]),
        ([(4, 5), (5, 5), (6, 5)], [(RIGHT, 1)]),  # pauses on the line
        ([(4, 5), (5, 5), (5, 5), (4, 5)], [(RIGHT, 1), (LEFT, 3)]),  # the line belongs to its right side
        ([(6, 5), (5, 5), (6, 5)], []),  # touches it from the right
        ([(4, 4), (6, 4)], [(RIGHT, 1)]),  # through its end
        ([(4, 3.9), (6, 3.9)], []),  # past its end
        ([(4, 5), (5, 3), (6, 5)], []),  # round its end
        ([(4, 5), (4.9, 5)], []),
        ([(5, 3), (5, 7)], []),  # along it
        ([(3, 5), (99, 5)], [(RIGHT, 1)]),  # in one long step
    ],
)
def test_the_centre_crosses_a_line(way: list[tuple[float, float]], crossings: list[tuple[str, int]]) -> None:
    assert kinds(drive(way, zones=[DOOR])) == crossings


def test_a_crossing_has_the_place_where_the_path_meets_the_line() -> None:
    (event,) = drive([(4, 4.5), (6, 5.5)], zones=[DOOR])
    assert event[4:] == (5.0, 5.0)


@for_all(200, places=st.lists(st.tuples(st.floats(4, 6), st.floats(3, 7)), min_size=2, max_size=30))
def test_crossings_of_an_endless_line_alternate_and_say_on_which_side_one_is(places: list[tuple[float, float]]) -> None:
    events = drive(places, zones=[line((5, -1e4), (5, 1e4))])
    names = [kind for kind, *_ in events]
    assert all(a != b for a, b in itertools.pairwise(names))
    left = places[0][0] < 5
    assert left + names.count(LEFT) - names.count(RIGHT) == (places[-1][0] < 5)


def test_static_things_enter_nothing() -> None:
    _, state = scene(obstacle(pose=[5, 1, 0]), zones=[BOX])
    assert state.events(0) == []


# fields of view -------------------------------------------------------------------------------------------------------
def test_a_target_is_seen_from_the_step_on_at_which_it_is_in_view() -> None:
    guard = obstacle(pose=[0, 0, 0], unobstructed=True)
    walker = robot(drive=DRIVES["omni"], parts=[circle(0.5)], behavior=None, pose=[3, -4, 0], control=[0, 1, 0])
    view = core.View(object=0, angle=math.pi / 2, reach=10.0, occlusion=False)
    world, state = scene(guard, walker, mode=1, views=[view], targets=[1])
    for _ in range(80):
        state.command[1, :2], state.given[1] = (0, 1), 1
        core.advance(world, state, 1)
    # the disc meets the edge x = |y| when its centre is 0.5 m from it, so at |y| = 3 + 0.5 * sqrt(2) = 3.707
    assert [(event[0], event[1], event[2], event[3]) for event in state.events(0)] == [
        ("sight_start", 3, 0, 1),
        ("sight_end", 78, 0, 1),
    ]


@for_all(
    60,
    poses=st.lists(
        st.lists(st.tuples(st.floats(0, 8), st.floats(0, 8), st.floats(-3, 3)), min_size=4, max_size=4),
        min_size=2,
        max_size=6,
    ),
    angle=st.floats(0.1, 7),
    reach=st.floats(0.5, 9),
    occlusion=st.booleans(),
)
def test_sights_are_what_in_view_says_at_every_step(
    poses: list[list[tuple[float, float, float]]], angle: float, reach: float, occlusion: bool
) -> None:
    bodies = [robot(drive=DRIVES["omni"], behavior=None, pose=list(pose)) for pose in poses[0][:3]]
    wall = obstacle(pose=[4, 4, 0], parts=[rectangle(2, 0.2)])
    views = [core.View(object=i, angle=angle, reach=reach, occlusion=occlusion) for i in (0, 2)]
    world, state = scene(*bodies, wall, mode=1, views=views, targets=[0, 1, 2])
    seen: set[tuple[int, int]] = set()
    for number, row in enumerate(poses):
        if number:
            for i in range(3):
                state.pose[i] = row[i]
            core.advance(world, state, 1, external=True)
        for kind, step, observer, target, *_ in state.events(0):
            if step == number and kind.startswith("sight"):
                (seen.add if kind == "sight_start" else seen.discard)((observer, target))
        assert seen == {(i, j) for i in (0, 2) for j in state.in_view(i, angle, reach, occlusion) if j != 3}


# worlds ---------------------------------------------------------------------------------------------------------------
def test_a_reset_begins_again() -> None:
    body = robot(drive=DRIVES["omni"], behavior=None, pose=[3, 1, 0])
    view = core.View(object=0, angle=7.0, reach=9.0, occlusion=False)
    other = robot(drive=DRIVES["omni"], behavior=None, pose=[5, 1, 0])
    world, state = scene(body, other, mode=1, zones=[BOX, line((4, 0), (4, 2))], views=[view], targets=[1])
    start = state.events(0)
    assert kinds(start) == [("zone_entry", 0), ("sight_start", 0)]
    state.pose[0] = [5, 1, 0]
    core.advance(world, state, 1, external=True)
    assert len(state.events(0)) > len(start)
    state.reset(np.ones(1, np.uint8), False)
    assert state.events(0) == start
    core.advance(world, state, 1)
    assert state.events(0) == start, "the way back to the start crosses nothing"


def test_worlds_without_zones_and_views_have_no_such_events() -> None:
    state = advanced(50, robot(pose=[0, 0, 0], goals=[[3.0, 0.0]]))
    assert [kind for kind, *_ in state.events(0)] == ["arrival"]


def test_what_does_not_exist_is_refused() -> None:
    with pytest.raises(ValueError, match="field of view"):
        scene(robot(), views=[core.View(object=1, angle=1.0, reach=1.0, occlusion=False)])
    with pytest.raises(ValueError, match="target"):
        scene(robot(), targets=[1])


# lines of sight -------------------------------------------------------------------------------------------------------
POINT = st.tuples(st.floats(0, 8), st.floats(0, 8))


@for_all(100, starts=st.lists(POINT, min_size=1, max_size=9), ends=st.lists(POINT, min_size=9, max_size=9))
def test_free_lines_are_those_of_shapely(starts: list[tuple[float, float]], ends: list[tuple[float, float]]) -> None:
    things = [
        obstacle(pose=[4, 4, 0.5], parts=[rectangle(3, 0.3)]),
        obstacle(pose=[2, 6, 0], parts=[circle(0.7)]),
        obstacle(pose=[6, 2, 0], parts=[line((-1, 0), (1, 0.5))]),
        obstacle(pose=[6, 6, 0], parts=[circle(0.7)]),  # does not count
        robot(drive=DRIVES["omni"], behavior=None, pose=[1, 1, 0], parts=[circle(0.9)]),  # can move
    ]
    turned = shapely.affinity.rotate(shapely.box(-1.5, -0.15, 1.5, 0.15), 0.5, origin=(0, 0), use_radians=True)
    blocks = shapely.union_all(
        [
            shapely.affinity.translate(turned, 4, 4),
            shapely.Point(2, 6).buffer(0.7, quad_segs=256),
            shapely.LineString([(5, 2), (7, 2.5)]),
        ]
    )
    world, state = scene(*things, mode=1)
    count = len(starts)
    blocking = np.array([1, 1, 1, 0, 1], np.uint8)
    free = core.free_lines(world, state, 0, np.array(starts), np.array(ends[:count]), blocking)
    for k in range(count):
        path = shapely.LineString([starts[k], ends[k]])
        gap = path.distance(blocks)
        if gap > 1e-3 or path.intersection(blocks).length > 1e-3:
            assert bool(free[k]) == (gap > 0), k


def test_a_line_that_is_not_finite_meets_nothing() -> None:
    world, state = scene(obstacle(pose=[1, 0, 0]))
    start, end = np.zeros((3, 2)), np.array([[2.0, 0.0], [math.nan, math.nan], [2.0, 0.0]])
    assert core.free_lines(world, state, 0, start, end, np.ones(1, np.uint8)).tolist() == [0, 1, 0]
