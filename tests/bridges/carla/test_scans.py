"""Places of CARLA in the frame of irsim, and scans of its lidars."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from irsim.bridges.carla.lidars import scan_of_points, usual_points
from irsim.bridges.carla.places import Places
from irsim.simulation.scene import Lidar

NUMBERS = st.floats(-1000, 1000)
PLACES = st.builds(Places, NUMBERS, NUMBERS, st.floats(-360, 360))
POSES = st.tuples(NUMBERS, NUMBERS, st.floats(-3.1, 3.1))


def test_worked_by_hand() -> None:
    assert Places().to_carla(np.array([1.0, 2.0, 0.5])) == pytest.approx([1, -2, -math.degrees(0.5)])
    turned = Places(10.0, 20.0, 90.0)  # the x axis of the scenario is the y axis of CARLA
    assert turned.to_carla(np.array([3.0, 0.0, 0.0])) == pytest.approx([10, 23, 90])
    assert turned.to_carla(np.array([0.0, 4.0, math.pi / 2])) == pytest.approx([14, 20, 0])
    assert turned.velocity_to_carla(np.array([0.0, 2.0, 1.0])) == pytest.approx([2, 0, -math.degrees(1)])


@given(PLACES, POSES)
def test_round_trip(places: Places, pose: tuple[float, float, float]) -> None:
    back = places.to_irsim(places.to_carla(np.array(pose)))
    assert back == pytest.approx(pose, abs=1e-8)
    assert places.velocity_to_irsim(places.velocity_to_carla(np.array(pose))) == pytest.approx(pose, abs=1e-8)


@given(PLACES, POSES)
def test_the_frame_is_left_handed_and_rigid(places: Places, pose: tuple[float, float, float]) -> None:
    assert np.linalg.det(places.matrix[:3, :3]) == pytest.approx(-1)
    np.testing.assert_allclose(places.matrix[:3, :3] @ places.matrix[:3, :3].T, np.eye(3), atol=1e-12)
    point = places.matrix @ np.array([*pose[:2], 0, 1])
    assert places.to_carla(np.array(pose))[:2] == pytest.approx(point[:2], abs=1e-8)


@given(PLACES, POSES)
def test_what_is_ahead_stays_ahead_and_left_becomes_minus_right(
    places: Places, pose: tuple[float, float, float]
) -> None:
    x, y, yaw = pose
    ahead = places.to_carla(np.array([x + math.cos(yaw), y + math.sin(yaw), 0]))
    left = places.to_carla(np.array([x - math.sin(yaw), y + math.cos(yaw), 0]))
    here = places.to_carla(np.array(pose))
    course = math.radians(here[2])  # CARLA: x along (cos, sin), y, which points to the right, along (-sin, cos)
    assert ahead[:2] - here[:2] == pytest.approx([math.cos(course), math.sin(course)], abs=1e-6)
    assert left[:2] - here[:2] == pytest.approx([math.sin(course), -math.cos(course)], abs=1e-6)


def _lidar(beams: int = 91, opening: float = math.pi, **more: Any) -> Lidar:
    facts = {"range_min": 0.0, "range_max": 10.0, "period": 0.1, **more}
    return Lidar("car/0", 0, (0.0, 0.0, 0.0), -opening / 2, opening / 2, beams, **facts)


def _points(ranges: Any, angles: Any, z: float = 0.0) -> Any:
    """Points of CARLA, whose y is to the right."""
    finite = np.isfinite(ranges)
    x, y = ranges[finite] * np.cos(angles[finite]), -ranges[finite] * np.sin(angles[finite])
    return np.stack([x, y, np.full(len(x), z), np.ones(len(x))], axis=1)


def _turn(count: int, start: float = 0.0) -> Any:
    return start + np.arange(count) * 2 * math.pi / count


@pytest.mark.parametrize("start", [0.0, 0.001, 0.0017, -1.3])
def test_a_straight_wall_is_exact_between_points(start: float) -> None:
    angles = _turn(720, start)
    with np.errstate(divide="ignore"):
        ranges = np.where(np.cos(angles) > 0, 2 / np.cos(angles), np.inf)
    lidar = _lidar()
    scan = scan_of_points(_points(ranges, angles), lidar, 720, -1, 1)
    wanted = 2 / np.cos(lidar.angles)
    near = wanted < 9.5
    np.testing.assert_allclose(scan[near], wanted[near], atol=1e-6)
    assert np.isinf(scan[wanted > 10.5]).all()


def test_left_is_left() -> None:
    angles = _turn(720)
    ranges = np.where((angles > 0.4) & (angles < 0.6), 3.0, np.inf)  # counterclockwise: to the left
    scan = scan_of_points(_points(ranges, angles), _lidar(), 720, -1, 1)
    seen = np.isfinite(scan)
    assert (_lidar().angles[seen] > 0.35).all()
    assert (_lidar().angles[seen] < 0.65).all()
    assert seen.sum() >= 5


def test_edges_do_not_make_points_in_the_air() -> None:
    angles = _turn(1440)
    ranges = np.where((angles > 6) | (angles < 0.3), 2.0, 7.0)
    scan = scan_of_points(_points(ranges, angles), _lidar(181), 1440, -1, 1)
    assert set(np.round(scan, 2)) == {2.0, 7.0}


def test_the_band_and_the_nearest_of_several_channels() -> None:
    angles = _turn(720)
    ground, box, bridge = (np.full(720, value) for value in (1.0, 4.0, 2.0))
    points = np.concatenate([
        _points(ground, angles, -1.2), _points(box, angles, 0.1), _points(box + 1, angles, 0.3),
        _points(bridge, angles, 2.5),
    ])  # fmt: skip
    np.testing.assert_allclose(scan_of_points(points, _lidar(), 720, -0.8, 1.0), 4.0, atol=1e-3)
    assert np.isinf(scan_of_points(points, _lidar(), 720, 3.0, 4.0)).all()
    assert np.isinf(scan_of_points(np.zeros((0, 4)), _lidar(), 720, -1, 1)).all()


def test_missing_points_are_bridged_by_nobody() -> None:
    angles = _turn(720)
    ranges = np.full(720, 5.0)
    ranges[100:200] = np.inf
    scan = scan_of_points(_points(ranges, angles), _lidar(721, 2 * math.pi), 720, -1, 1)
    directions = np.mod(_lidar(721, 2 * math.pi).angles, 2 * math.pi)
    gap = (directions > angles[101]) & (directions < angles[198])
    assert np.isinf(scan[gap]).all()
    assert np.isfinite(scan[~gap]).mean() > 0.98


def test_hostile_points() -> None:
    points = np.array([[np.nan, 1, 0, 1], [np.inf, 0, 0, 1], [0, 0, 0, 1], [3, 0, 0, 1]])
    scan = scan_of_points(points, _lidar(1, 0.0), 720, -1, 1)
    assert not np.isnan(scan).any()


def test_number_of_points() -> None:
    assert usual_points(_lidar(181, math.pi)) == 1440
    assert usual_points(_lidar(1, 0.0)) == 720
    assert usual_points(_lidar(1_000_000, 1.0)) == 20_000
