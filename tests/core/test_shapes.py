"""Bounding circles, vertices, random shapes, and the exact test of two shapes against shapely."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import assume
from hypothesis import strategies as st
from shapely import affinity

import irsim._core as core
from tests.core import oracle
from tests.core.worlds import circle, line, obstacle, polygon, rectangle, scene
from tests.effort import for_all

COORDINATE = st.floats(-5, 5).map(lambda v: round(v, 3))
POINT = st.tuples(COORDINATE, COORDINATE)


def radius_of(*parts) -> float:
    _, state = scene(obstacle(parts=list(parts)))
    return float(state.radius[0])


def test_radius_of_simple_shapes() -> None:
    assert radius_of(circle(0.7, (3, 4))) == 0.7
    assert radius_of(rectangle(3, 4)) == pytest.approx(2.5)
    assert radius_of(line((0, 0), (2, 0))) == pytest.approx(1.0)
    assert radius_of(polygon((0, 0), (4, 0), (2, 0.5))) == pytest.approx(2.0)  # obtuse: two vertices hold it
    assert radius_of(polygon((1, 1))) == 0.0


@for_all(60, st.lists(POINT, min_size=2, max_size=12))
def test_radius_is_the_minimum_bounding_circle_of_the_vertices(points) -> None:
    expected = shapely.minimum_bounding_radius(shapely.MultiPoint(points))
    assert radius_of(line(*points)) == pytest.approx(expected, abs=1e-6)  # GEOS is the less exact one


@for_all(40, st.lists(st.tuples(COORDINATE, COORDINATE, st.sampled_from([0.0, 0.5, 1.0, 2.7])), min_size=1, max_size=5))
def test_radius_of_a_union_of_discs_is_the_smallest_that_holds_them(discs) -> None:
    radius = radius_of(*(circle(r, (x, y)) for x, y, r in discs))
    edge = [
        (x + r * math.cos(a), y + r * math.sin(a)) for x, y, r in discs for a in np.linspace(0, 2 * np.pi, 241)[:-1]
    ]
    inner = shapely.minimum_bounding_radius(shapely.MultiPoint(edge))
    assert inner - 1e-6 <= radius <= inner + 3e-3


@for_all(40, POINT, st.floats(-4, 4))
def test_world_frame_vertices(position, theta: float) -> None:
    _, state = scene(obstacle(pose=[*position, theta], parts=[polygon((0, 0), (2, 0), (0, 1)), circle(0.3, (1, 1))]))
    turn = oracle.rotation(theta)
    assert state.parts(0) == ["polygon", "circle"]
    np.testing.assert_array_equal(state.vertices(0, 0, False), [(0, 0), (2, 0), (0, 1)])
    np.testing.assert_allclose(
        state.vertices(0, 0, True), [turn @ v + position for v in np.array([(0, 0), (2, 0), (0, 1)])], atol=1e-12
    )
    x, y, r = state.circle(0, 1, True)
    np.testing.assert_allclose([x, y], turn @ [1, 1] + position, atol=1e-12)
    assert r == 0.3
    assert state.vertices(0, 1, True).shape == (0, 2)
    with pytest.raises(ValueError, match="not a circle"):
        state.circle(0, 0, True)
    with pytest.raises(IndexError):
        state.vertices(0, 2, True)


def random_polygon(**overrides) -> core.RandomPolygon:
    options = {
        "center_range": [-1, -2, 1, 2],
        "avg_radius_range": [0.5, 1.5],
        "irregularity_range": [0, 1],
        "spikeyness_range": [0, 1],
        "num_vertices_range": [4, 10],
        "closed": True,
    }
    return core.RandomPolygon(**{**options, **overrides})


def test_random_polygons_are_simple_and_differ_by_object_and_scene() -> None:
    _, state = scene(*(obstacle(parts=[random_polygon()]) for _ in range(60)), seeds=[3])
    first = [state.vertices(i, 0, False) for i in range(60)]
    assert all(shapely.Polygon(v).is_valid for v in first)
    assert all(shapely.Polygon(v).exterior.is_ccw for v in first)
    assert {len(v) for v in first} == set(range(4, 10))
    assert len({v.tobytes() for v in first}) == 60
    state.reset(np.ones(1, np.uint8), False)
    assert all(np.array_equal(v, state.vertices(i, 0, False)) for i, v in enumerate(first))
    state.reset(np.ones(1, np.uint8), True)
    assert not any(np.array_equal(v, state.vertices(i, 0, False)) for i, v in enumerate(first))


def test_convex_random_polygons_lie_on_a_circle() -> None:
    part = random_polygon(spikeyness_range=[0, 0], center_range=[0, 0, 0, 0])
    _, state = scene(*(obstacle(parts=[part]) for _ in range(20)))
    for i in range(20):
        v = state.vertices(i, 0, False)
        distances = np.hypot(*v.T)
        np.testing.assert_allclose(distances, distances[0], rtol=1e-12)
        assert 0.5 <= distances[0] <= 1.5
        assert shapely.Polygon(v).convex_hull.area == pytest.approx(shapely.Polygon(v).area)


def test_random_polygons_follow_the_published_model() -> None:
    part = random_polygon(irregularity_range=[0, 0], spikeyness_range=[0.2, 0.2], num_vertices_range=[6, 7])
    _, state = scene(*(obstacle(parts=[part]) for _ in range(300)), seeds=[9])
    u = oracle.draws(9, 0, 0, core.STREAMS["shape"], 4, 5)
    centre = np.array([-1 + 2 * u[0], -2 + 4 * u[1]])
    mean = 0.5 + u[2]
    v = state.vertices(4, 0, False) - centre
    angles = np.unwrap(np.arctan2(v[:, 1], v[:, 0]))
    np.testing.assert_allclose(np.diff(angles), np.pi / 3, atol=1e-9)
    assert np.hypot(*v.T).max() <= 2 * mean
    spread = []
    for i in range(300):
        u = oracle.draws(9, 0, 0, core.STREAMS["shape"], i, 3)
        v = state.vertices(i, 0, False) - [-1 + 2 * u[0], -2 + 4 * u[1]]
        spread += list(np.hypot(*v.T) / (0.5 + u[2]))
    assert np.mean(spread) == pytest.approx(1.0, abs=0.02)
    assert np.std(spread) == pytest.approx(0.2, abs=0.02)


def test_random_linestrings_are_open() -> None:
    _, state = scene(obstacle(parts=[random_polygon(closed=False)]))
    assert state.parts(0) == ["linestring"]


def test_random_circles() -> None:
    part = core.RandomCircle(radius_range=[0.5, 2.0], center=[1, 0])
    _, state = scene(*(obstacle(parts=[part, part]) for _ in range(20)), seeds=[4])
    for i in range(20):
        u = oracle.draws(4, 0, 0, core.STREAMS["shape"], i, 1)[0]
        assert state.circle(i, 0, False) == pytest.approx((1.0, 0.0, 0.5 + 1.5 * u))
        assert state.circle(i, 1, False) != state.circle(i, 0, False)


ORIGIN = (0.0, 0.0, 0.0)
GRID = st.integers(-4, 4).map(float)  # a coarse grid, so that things touch exactly
FINE = st.floats(-4, 4).map(lambda v: round(v, 4))


@st.composite
def shape(draw: st.DrawFn):
    """A part and its shapely geometry with the radius by which it grows."""
    number = draw(st.sampled_from([GRID, FINE]))
    kind = draw(st.sampled_from(["circle", "polygon", "linestring"]))
    if kind == "circle":
        x, y, r = draw(number), draw(number), draw(st.sampled_from([0.5, 1.0, 1.7]))
        return circle(r, (x, y)), shapely.Point(x, y), r
    points = draw(st.lists(st.tuples(number, number), min_size=3, max_size=7, unique=True))
    if kind == "linestring":
        return line(*points), shapely.LineString(points), 0.0
    ring = shapely.Polygon(points)
    assume(ring.is_valid and ring.area > 0)
    return polygon(*points), ring, 0.0


def placed(geometry, pose):
    return affinity.translate(affinity.rotate(geometry, pose[2], origin=(0, 0), use_radians=True), pose[0], pose[1])


@for_all(150, a=st.lists(shape(), min_size=1, max_size=3), b=st.lists(shape(), min_size=1, max_size=2))
def test_exact_where_they_stand(a, b) -> None:
    gaps = [ga.distance(gb) - ra - rb for _, ga, ra in a for _, gb, rb in b]
    round_ = any(r for *_, r in [*a, *b])
    assume(not round_ or abs(min(gaps)) > 1e-9)
    expected = min(gaps) <= 0
    assert core.intersects([p for p, *_ in a], ORIGIN, [p for p, *_ in b], ORIGIN) == expected
    assert core.intersects([p for p, *_ in b], ORIGIN, [p for p, *_ in a], ORIGIN) == expected


POSE = st.tuples(FINE, FINE, st.floats(-math.pi, math.pi))


@for_all(100, a=shape(), b=shape(), pose_a=POSE, pose_b=POSE)
def test_in_any_pose(a, b, pose_a, pose_b) -> None:
    shape_a, shape_b = placed(a[1], pose_a), placed(b[1], pose_b)
    gap = shape_a.distance(shape_b) - a[2] - b[2]
    if gap > 1e-9:
        assert not core.intersects([a[0]], pose_a, [b[0]], pose_b)
    # clearly overlapping: by more than rounding of the poses can undo
    elif gap < -1e-9 or shape_a.buffer(a[2]).intersection(shape_b.buffer(b[2])).buffer(-1e-6).area > 0:
        assert core.intersects([a[0]], pose_a, [b[0]], pose_b)


@pytest.mark.parametrize(
    ("a", "b", "meet"),
    [
        (circle(1, (0, 0)), circle(1, (2, 0)), True),
        (circle(1, (0, 0)), circle(1, (2.000001, 0)), False),
        (circle(1, (0, 0)), circle(0.1, (0.2, 0)), True),
        (circle(1, (0, 0)), line((1, -3), (1, 3)), True),
        (circle(1, (0, 0)), line((1.000001, -3), (1.000001, 3)), False),
        (circle(0.1, (0, 0)), rectangle(4, 4), True),  # inside
        (
            circle(0.1, (0, 0)),
            line((-2, -2), (2, -2), (2, 2), (-2, 2), (-2, -2)),
            False,
        ),  # a closed line is not an area
        (rectangle(1, 1), rectangle(9, 9), True),
        (rectangle(2, 2), polygon((1, 1), (2, 1), (2, 2)), True),  # a corner
        (rectangle(2, 2), polygon((1, -0.5), (2, -0.5), (2, 0.5), (1, 0.5)), True),  # part of an edge
        (rectangle(2, 2), line((1, 5), (1, 0)), True),
        (rectangle(2, 2), line((0, 0), (0.1, 0.1)), True),
        # the notch of an L, empty and filled
        (polygon((0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)), circle(0.5, (2, 2)), False),
        (polygon((0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)), circle(1.0, (2, 2)), True),
        (line((0, 0), (1, 1)), line((1, 1), (2, 0)), True),
        (line((0, 0), (2, 0)), line((1, 0), (5, 0)), True),
        (line((0, 0), (2, 0)), line((3, 0), (5, 0)), False),
        (circle(0, (1, 1)), circle(0, (1, 1)), True),
        (polygon((0, 0)), polygon((0, 0)), True),
        (polygon((0, 0), (1, 1)), circle(0.1, (0.5, 0.5)), True),
    ],
)
def test_cases(a, b, meet: bool) -> None:
    assert core.intersects([a], ORIGIN, [b], ORIGIN) == meet
    assert core.intersects([b], ORIGIN, [a], ORIGIN) == meet
