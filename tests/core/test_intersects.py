"""The exact test of two shapes, against shapely."""

from __future__ import annotations

import math

import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely import affinity

import irsim._core as core
from tests.core.worlds import circle, line, polygon, rectangle
from tests.effort import examples

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


@settings(max_examples=examples(150))
@given(a=st.lists(shape(), min_size=1, max_size=3), b=st.lists(shape(), min_size=1, max_size=2))
def test_exact_where_they_stand(a, b) -> None:
    gaps = [ga.distance(gb) - ra - rb for _, ga, ra in a for _, gb, rb in b]
    round_ = any(r for *_, r in [*a, *b])
    assume(not round_ or abs(min(gaps)) > 1e-9)
    expected = min(gaps) <= 0
    assert core.intersects([p for p, *_ in a], ORIGIN, [p for p, *_ in b], ORIGIN) == expected
    assert core.intersects([p for p, *_ in b], ORIGIN, [p for p, *_ in a], ORIGIN) == expected


POSE = st.tuples(FINE, FINE, st.floats(-math.pi, math.pi))


@settings(max_examples=examples(100))
@given(a=shape(), b=shape(), pose_a=POSE, pose_b=POSE)
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
