"""Maps of CARLA without a server, read by the official client: they confirm the frame."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from irsim.bridges.carla.places import Places
from irsim.bridges.doctor import LEFT_CURVE, examine

pytestmark = pytest.mark.interop


@pytest.fixture
def carla() -> Any:
    return pytest.importorskip("carla")


def test_a_left_curve_has_negative_y_and_negative_yaw_in_carla(carla: Any) -> None:
    road = carla.Map("curve", LEFT_CURVE)
    at = [road.get_waypoint_xodr(1, -1, float(s)).transform for s in range(1, 20)]
    yaw = np.array([math.remainder(one.rotation.yaw, 360) for one in at])
    assert (yaw < 0).all()
    assert (np.diff(yaw) < 0).all()
    assert at[-1].location.y < -5
    places = Places()
    poses = places.to_irsim(np.array([[one.location.x, one.location.y, one.rotation.yaw] for one in at]))
    s = np.arange(1, 20)
    radius = 21.75  # an arc with the radius 20 m, whose right lane is 3.5 m wide
    np.testing.assert_allclose(poses[:, 0], radius * np.sin(s / 20), atol=0.02)
    np.testing.assert_allclose(poses[:, 1], 20 - radius * np.cos(s / 20), atol=0.02)
    np.testing.assert_allclose(poses[:, 2], s / 20, atol=0.01)


def test_transforms_of_the_client_turn_as_ours(carla: Any) -> None:
    places = Places(12.0, -7.0, 140.0)
    for pose in ([0.0, 0.0, 0.0], [3.0, -2.0, 1.0], [-5.0, 4.0, -2.5]):
        x, y, yaw = places.to_carla(np.array(pose))
        transform = carla.Transform(carla.Location(x=x, y=y), carla.Rotation(yaw=yaw))
        ahead = transform.transform(carla.Location(x=2.0))
        left = transform.transform(carla.Location(y=-1.0))
        wanted = places.to_carla(
            np.array(
                [
                    [pose[0] + 2 * math.cos(pose[2]), pose[1] + 2 * math.sin(pose[2]), 0],
                    [pose[0] - math.sin(pose[2]), pose[1] + math.cos(pose[2]), 0],
                ]
            )
        )
        assert (ahead.x, ahead.y) == pytest.approx(wanted[0, :2].tolist(), abs=1e-4)
        assert (left.x, left.y) == pytest.approx(wanted[1, :2].tolist(), abs=1e-4)


def test_the_doctor_tries_the_client(carla: Any) -> None:
    (health,) = examine(["carla"])
    assert health.state == "ready"
    assert health.version.startswith("0.9.")
