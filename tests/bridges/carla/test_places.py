"""Frames: y and yaw change their signs, and everything comes back."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from irsim.bridges.carla.places import Places

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
