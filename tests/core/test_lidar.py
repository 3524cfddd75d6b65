"""Lidar, against every beam times every edge."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import irsim._core as core
from tests.core import oracle
from tests.core.worlds import PI, circle, lidar, line, obstacle, polygon, rectangle, robot, scene
from tests.effort import for_all

SHAPES = [
    circle(0.5),
    circle(0.3, (0.2, -0.4)),
    rectangle(1, 2),
    rectangle(14, 12),  # around the sensor
    polygon((0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)),
    polygon((0, 0), (0, 1), (1, 1)),  # clockwise
    line((-2, 0), (0, 1), (2, 0), (1, -1)),
]


@for_all(150, st.data())
def test_scans_are_those_of_every_beam_against_every_edge(data: st.DataObject) -> None:
    coarse = data.draw(st.booleans())  # poses on a grid: beams meet corners and run along edges
    rng = np.random.default_rng(data.draw(st.integers(0, 10_000)))
    number = data.draw(st.sampled_from([1, 2, 3, 4, 8, 9, 37, 90]))
    spread = data.draw(st.sampled_from([0.5 * PI, PI, 2.0, 2 * PI - 0.3, 2 * PI, 0.0]))
    offset = data.draw(st.sampled_from([[0, 0, 0], [0.5, -0.25, 0], [0, 0, 0.5 * PI], [-1, 1, -2.5]]))
    reach = data.draw(st.sampled_from([0.7, 6.0, 30.0]))
    count = data.draw(st.integers(0, 12))
    poses = rng.uniform([-5, -5, -PI], [5, 5, PI], (count, 3))
    own = rng.uniform([-1, -1, -PI], [1, 1, PI])
    if coarse:
        poses[:, :2], own[:2] = np.round(poses[:, :2]), np.round(own[:2])
        poses[:, 2], own[2] = np.round(poses[:, 2]) * PI / 2, round(own[2]) * PI / 4
    sensor = lidar(number, range_max=reach, angle_range=spread, offset=offset)
    _, state = scene(
        robot(pose=own.tolist(), sensors=[sensor]),
        *(
            obstacle(pose=p, parts=[SHAPES[rng.integers(len(SHAPES))]], static=bool(k % 2))
            for k, p in enumerate(poses.tolist())
        ),
        mode=1,
    )
    angles = state.beam_angles
    np.testing.assert_allclose(
        angles, np.linspace(-spread / 2, spread / 2, number) if number > 1 else [0.0], atol=1e-15
    )
    x, y, theta = state.pose[0]
    origin = np.array([x, y]) + oracle.rotation(theta) @ offset[:2]
    oracle.assert_scan(state, slice(None), range(1, count + 1), [*origin, theta + offset[2]], reach)


def test_many_bodies_and_a_moving_sensor() -> None:
    rng = np.random.default_rng(1)
    poses = rng.uniform([-12, -12, -PI], [12, 12, PI], (100, 3)).tolist()
    world, state = scene(
        robot(sensors=[lidar(60), lidar(11, angle_range=1.0)], behavior=None, control=[1, 0.4, 0]),
        *(obstacle(pose=p, parts=[SHAPES[k % 3]]) for k, p in enumerate(poses)),
        mode=1,
    )
    assert world.scans() == [(0, 0, 60), (0, 60, 11)]
    for _ in range(3):
        state.command[0, :2], state.given[0] = [1.0, 0.4], 1
        core.advance(world, state, 4)
        for beams in (slice(0, 60), slice(60, 71)):
            oracle.assert_scan(state, beams, range(1, 101), state.pose[0], 10.0)


def look(*objects: core.ObjectSpec, number: int = 1, **options) -> core.State:
    return scene(robot(sensors=[lidar(number, **options)]), *objects, mode=1)[1]


def test_the_first_beam_is_the_rightmost() -> None:
    state = look(obstacle(pose=[0, -2, 0], parts=[circle(0.5)]), number=3, angle_range=PI)
    np.testing.assert_allclose(state.ranges, [1.5, 10, 10])
    assert state.hits.tolist() == [1, -1, -1]


def thing(*parts: core.Part, x: float = 0.0, **options) -> core.ObjectSpec:
    return obstacle(pose=[x, 0, 0], parts=list(parts), **options)


WALL = thing(line((2, -1), (2, 1)))
LOOKS = {
    "nothing, not itself": ([], {}, 10.0, -1),
    "the exit from inside a circle": ([thing(circle(2.0))], {}, 2.0, 1),
    "the exit from inside a box": ([thing(rectangle(6, 4))], {}, 3.0, 1),
    "from its boundary not the near side of a box": ([thing(rectangle(6, 4), x=3)], {}, 6.0, 1),
    "from its boundary not the near side of a circle": ([thing(circle(2.0), x=2)], {}, 4.0, 1),
    "the nearest end of an edge along the beam": ([thing(line((2, 0), (4, 0)))], {}, 2.0, 1),
    "the end ahead of an edge on which it stands": ([thing(line((4, 0), (-2, 0)))], {}, 4.0, 1),
    "what is at the limit": ([WALL], {"range_max": 2.0}, 2.0, 1),
    "nothing beyond the limit": ([WALL], {"range_max": 1.9}, 1.9, -1),
    "what is too near, at the lower limit": ([WALL], {"range_min": 3.0}, 3.0, 1),
    "a robot": ([robot(pose=[2, 0, 0], parts=[circle(0.5)])], {}, 1.5, 1),
    "nothing unobstructed": ([thing(circle(0.5), x=2, unobstructed=True)], {}, 10.0, -1),
    "the first of equally near objects": ([thing(circle(), x=20), WALL, WALL], {}, 2.0, 2),
}


@pytest.mark.parametrize("seen", LOOKS)
def test_a_beam_ahead_hits(seen: str) -> None:
    objects, options, distance, hit = LOOKS[seen]
    state = look(*objects, **options)
    assert (state.ranges[0], state.hits[0]) == (pytest.approx(distance, abs=1e-15), hit)


def test_beams_do_not_slip_through_corners() -> None:
    ring = [(2 * math.cos(a), 2 * math.sin(a)) for a in np.linspace(0, 2 * PI, 361)[:-1]]
    state = look(obstacle(parts=[polygon(*ring)]), number=721)
    assert (state.hits == 1).all()


COMPOUNDS = [
    [rectangle(2, 2), circle(1.2, (1, 0))],
    [rectangle(4, 1), polygon((-0.5, -2), (0.5, -2), (0.5, 2), (-0.5, 2))],
    [polygon((0, 0), (2, 0), (2, 2), (0, 2)), polygon((2, 0), (4, 0), (4, 2), (2, 2))],  # share an edge
    [circle(1.0), circle(1.0, (0.5, 0.5)), circle(0.2)],
    [polygon((0, 2), (2, 2), (2, 0), (0, 0)), line((-1, 1), (3, 1))],
]


def edges_of(state: core.State, row: int) -> shapely.Geometry:
    whole = oracle.shape_of(state, row)
    pieces = getattr(whole, "geoms", [whole])
    return shapely.union_all([piece if piece.geom_type == "LineString" else piece.boundary for piece in pieces])


@pytest.mark.parametrize("parts", COMPOUNDS)
@settings(max_examples=15)
@given(x=st.floats(-3, 5), y=st.floats(-3, 4), theta=st.floats(-3, 3))
def test_compounds_show_the_boundary_of_their_union(parts, x: float, y: float, theta: float) -> None:
    sensor = lidar(40, angle_range=6.0)
    _, state = scene(robot(pose=[x, y, theta], sensors=[sensor]), obstacle(parts=parts), mode=1)
    boundary, origin = edges_of(state, 1), shapely.Point(x, y)
    if boundary.distance(origin) < 1e-3:
        return
    wrong = 0
    for angle, measured in zip(state.beam_angles + theta, state.ranges, strict=True):
        end = (x + 10 * math.cos(angle), y + 10 * math.sin(angle))
        hit = shapely.LineString([(x, y), end]).intersection(boundary)
        expected = 10.0 if hit.is_empty else origin.distance(hit)
        wrong += abs(measured - expected) > 1e-3
    assert wrong <= 1  # a beam that grazes an edge, or a round part, which shapely has as a polygon


def scan_errors(state: core.State, number: int, index: int) -> np.ndarray:
    """(2, beams) range and direction errors of a scan of object 0, in standard deviations."""
    draws = int(state.count[0]) * 2 * number + np.arange(2 * number)
    stream = core.STREAMS["sensor"] + 16 * index
    key = (int(state.seed[0]), int(state.scene[0]), int(state.noise[0]), stream, 0)
    return np.array([oracle.normals(core.random_bits(*key, int(d) // 4))[d % 4] for d in draws]).reshape(2, number)


@pytest.mark.parametrize("angle_std", [0.02, 0.5, 3.0])
def test_noise(angle_std: float) -> None:
    sensors = [lidar(5), lidar(24, noise=True, std=0.2, angle_std=angle_std, angle_range=4.0)]
    boxes = [obstacle(pose=[3 * math.cos(a), 3 * math.sin(a), a], parts=[rectangle(1, 1)]) for a in range(5)]
    world, state = scene(robot(sensors=sensors), *boxes, seeds=[6], mode=1)
    for _ in range(2):
        state.command[0], state.given[0] = [0.5, 0.2, 0], 1
        core.advance(world, state, 1)
        range_error, angle_error = scan_errors(state, 24, 1)
        nominal = np.linspace(-2, 2, 24)
        np.testing.assert_allclose(state.beam_angles[5:], nominal, atol=1e-15)
        aim, error = nominal + angle_std * angle_error, 0.2 * range_error
        oracle.assert_scan(state, slice(5, None), range(1, 6), state.pose[0], 10.0, aim, error)
        oracle.assert_scan(state, slice(0, 5), range(1, 6), state.pose[0], 10.0)  # std alone makes no noise


def test_carriers_may_be_static_and_several() -> None:
    _, state = scene(obstacle(sensors=[lidar(1)]), robot(pose=[3, 0, PI], sensors=[lidar(1)]), seeds=[1, 2], mode=1)
    np.testing.assert_allclose(state.ranges, 2.8)
    assert state.hits.tolist() == [1, 0, 1, 0]
