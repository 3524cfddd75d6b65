"""Vehicles and lidars in the town of a stand-in (not CARLA): commands cross, and points become scans."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from tests.interop.carla.conftest import StandIn
from tests.interop.carla.scenes import DRIVE, YARD, in_town

pytestmark = pytest.mark.interop
PLACE = (-20.0, 35.0, -70.0)
CAR = {
    "drive": "acker",
    "shape": "{name: rectangle, length: 3.0, width: 1.4, wheelbase: 2.0}",
    "state": "[2, 2, 0]",
    "goal": "[9, 6]",
    "vel_max": "[1.5, 0.6]",
    "vel_min": "[-1.5, -0.6]",
}
CART = {**CAR, "drive": "diff", "shape": "{name: circle, radius: 0.3}", "vel_max": "[1.2, 1]", "vel_min": "[-1.2, -1]"}
WALL = in_town(YARD[:, 0], YARD[:, 1], PLACE).tolist()


class Drive:
    """A run of the car in the yard.

    Attributes:
        pose: (T, 3) of the car.
        own: (T, 181) what irsim measures where the car is.
        seen: (T, 181) what its policy got.
    """

    def __init__(self, path: Path, town: StandIn, steps: int, more: str, kind: dict[str, str]) -> None:
        wall = [list(map(float, point)) for point in YARD]
        path.write_text(DRIVE.format(port=town.port, more=more, wall=wall, **kind))
        env = irsim.make(path, display=False)
        own: list[Any] = []
        pose, seen = [env.simulation.pose[0].copy()], []
        with irsim.connect(env) as self.connection:
            simulation = env.simulation
            simulation.measurements.insert(0, lambda simulation, _: own.append(simulation.ranges.copy()))
            for _ in range(steps):
                env.step()
                pose.append(simulation.pose[0].copy())
                seen.append(simulation.ranges.copy())
        self.pose, self.own, self.seen = np.array(pose), np.array(own), np.array(seen)
        self.env = env


def _smooth(ranges: Any) -> Any:
    """Beams whose neighbours hit the same surface."""
    bent = np.abs(np.diff(ranges, n=2, axis=1)) < 0.1
    return np.pad(bent, ((0, 0), (1, 1)))


@pytest.mark.parametrize("mount", ["", ", channels: 8, upper: 10, lower: -30, height: 1.2"])
def test_points_become_the_scan_that_irsim_measures(
    stand_in: Callable[..., StandIn], tmp_path: Path, mount: str
) -> None:
    town = stand_in(walls=[WALL], ground=0.4)
    more = f", vehicles: [car], command: velocity, lidar: {{robots: [car]{mount}}}"
    run = Drive(tmp_path / "drive.yaml", town, 50, more, CART)
    assert run.seen.shape == run.own.shape == (50, 181)
    assert (run.own < 9).mean() > 0.9  # walls are near
    assert np.hypot(*(run.pose[-1] - run.pose[0])[:2]) > 3
    surface = _smooth(run.own)
    assert surface.mean() > 0.9
    away = np.abs(run.seen - run.own)
    assert away[surface].max() < 0.02
    assert np.median(away) < 0.001
    assert (away > 0.02).mean() < 0.02  # at edges the two may see different sides
    town.check_clean()


def test_a_walker_sees_in_the_direction_of_its_object(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    run = Drive(tmp_path / "drive.yaml", stand_in(walls=[WALL]), 40, ", lidar: {}", CART)
    assert run.connection.bridges[0].agents == set()
    away = np.abs(run.seen - run.own)
    assert np.abs(np.diff(run.pose[:, 2])).max() > 0.05  # it turns, and looks where it will walk
    assert away[_smooth(run.own)].max() < 0.02
    assert (away > 0.02).mean() < 0.02


def test_a_scan_differs_without_the_town(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    run = Drive(tmp_path / "drive.yaml", stand_in(), 5, ", vehicles: [car], command: velocity, lidar: {}", CART)
    assert (run.own < 9).mean() > 0.8
    assert (run.seen < 9).mean() < 0.1  # the town has no wall: what the policy sees is what CARLA measures


def test_a_left_turn_is_a_left_turn(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    town = stand_in(walls=[WALL])
    run = Drive(tmp_path / "drive.yaml", town, 25, "", CAR)
    first = town.events("ackermann")[1]
    assert run.pose[25, 2] > 0.3  # counterclockwise in irsim
    assert first["steer"] == pytest.approx(-math.atan2(4, 7), abs=1e-3)  # negative is left in CARLA
    assert 0.5 < first["speed"] <= 1.5
    town_path = town.path_of("car")[-26:]
    assert np.all(np.diff(town_path[:, 2])[1:6] < 0)  # and its yaw falls
    ahead = 1.0  # from the rear axle to the middle of the car
    x = run.pose[:, 0] + ahead * np.cos(run.pose[:, 2])
    y = run.pose[:, 1] + ahead * np.sin(run.pose[:, 2])
    np.testing.assert_allclose(town_path[:, :2], in_town(x, y, PLACE), atol=1e-3)
    yaw = PLACE[2] - np.degrees(run.pose[:, 2])
    assert np.abs(np.remainder(town_path[:, 2] - yaw + 180, 360) - 180).max() < 0.01
    assert run.connection.bridges[0].agents == {"car"}
    town.check_clean()


def test_the_steering_angle_is_that_of_the_vehicle(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    town = stand_in()
    Drive(tmp_path / "drive.yaml", town, 3, ", wheelbase: 3", CAR)
    assert town.events("ackermann")[1]["steer"] == pytest.approx(-math.atan(1.5 * 4 / 7), abs=1e-3)


def test_velocities_cross_with_their_signs(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    town = stand_in()
    run = Drive(tmp_path / "drive.yaml", town, 12, ", vehicles: [car], command: velocity", CART)
    turn = town.events("turn")[0]["rate"]
    assert run.pose[12, 2] > 0.3
    assert turn[:2] == [0, 0]
    assert turn[2] < -20  # counterclockwise is negative in CARLA, in degrees
    path = town.path_of("car")[-13:]
    np.testing.assert_allclose(path[:, :2], in_town(run.pose[:, 0], run.pose[:, 1], PLACE), atol=1e-3)
    moved = run.pose[12, :2] - run.pose[11, :2]
    velocity = town.events("velocity")[11]["velocity"][:2]
    np.testing.assert_allclose(velocity, (in_town(*moved, (0, 0, PLACE[2]))) / 0.1, atol=1e-3)


def test_the_scenario_moves_vehicles_too(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    town = stand_in(ground=0.7)
    run = Drive(tmp_path / "drive.yaml", town, 20, ", command: transform, vehicle_blueprint: vehicle.micro.*", CAR)
    assert run.connection.bridges[0].agents == set()
    path = town.path_of("car")[-21:]
    x = run.pose[:, 0] + np.cos(run.pose[:, 2])
    y = run.pose[:, 1] + np.sin(run.pose[:, 2])
    np.testing.assert_allclose(path[:, :2], in_town(x, y, PLACE), atol=1e-3)
    assert {round(event["pose"][0][2], 3) for event in town.events("transform")} == {0.7}
    assert "vehicle.micro.microlino" in {event["blueprint"] for event in town.events("spawn")}
    town.check_clean()


def test_an_object_follows_an_actor_of_others(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    other = in_town(np.array(3.0), np.array(4.0), PLACE).tolist()
    others = [["traffic", "vehicle.tesla.model3", *other, -20.0]]
    town = stand_in(others=others, others_do=["velocity", 1.0, 0.5])
    run = Drive(tmp_path / "drive.yaml", town, 20, ", vehicles: [], walkers: [walker], follow: {car: traffic}", CART)
    assert run.connection.bridges[0].agents == {"car"}
    number = "21"
    places = np.array([e["places"][number][1:] for e in town.events("tick")])[-20:]
    np.testing.assert_allclose(places[:, :2], in_town(run.pose[1:, 0], run.pose[1:, 1], PLACE), atol=1e-3)
    assert np.hypot(*(places[-1] - places[0])[:2]) > 2
    assert np.radians(-(places[:, 3] - PLACE[2])) == pytest.approx(run.pose[1:, 2], abs=1e-3)
    assert run.env.simulation.twist[0, :2] == pytest.approx(
        np.linalg.solve(in_town(*np.eye(2), (0, 0, PLACE[2])).T, [1.0, 0.5]), abs=1e-2
    )
    assert 21 not in {event["id"] for event in town.events("destroy")}
    town.check_clean()


def test_a_reset_puts_all_actors_back(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    town = stand_in(walls=[WALL])
    wall = [list(map(float, point)) for point in YARD]
    path = tmp_path / "drive.yaml"
    path.write_text(DRIVE.format(port=town.port, more="", wall=wall, **CAR))
    env = irsim.make(path, display=False)
    with irsim.connect(env):
        for _ in range(10):
            env.step()
        env.reset()
        env.step()
    car = town.path_of("car")
    start = in_town(np.array(3.0), np.array(2.0), PLACE)
    assert np.hypot(*(car[-1, :2] - start)) < 0.2
    assert np.hypot(*(car[-2, :2] - start)) < 0.01
    town.check_clean()
