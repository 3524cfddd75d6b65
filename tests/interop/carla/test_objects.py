"""Pedestrians, vehicles and lidars in the town of a stand-in (not CARLA), through the official client."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.bridges.doctor import LEFT_CURVE
from tests.bridges.scenes import environment
from tests.interop.carla.conftest import CROWD, DRIVE, YARD, StandIn, StartTown, in_town

pytestmark = pytest.mark.interop
PLACE = (100.0, -50.0, 30.0)


def _walk(town: StandIn, steps: int, more: str = "") -> tuple[Any, Any]:
    """Poses (steps + 1, N, 3) of the scenario, and its names."""
    env = environment(CROWD.format(port=town.port, timeout=5, more=more))
    with irsim.connect(env) as connection:
        poses = [env.simulation.pose.copy()]
        for _ in range(steps):
            env.step()
            poses.append(env.simulation.pose.copy())
    return np.array(poses), connection


@pytest.mark.parametrize("drift", [0.0, 0.1])
def test_pedestrians_are_where_the_scenario_has_them(stand_in: StartTown, drift: float) -> None:
    town = stand_in(ground=0.3, drift=drift)
    poses, connection = _walk(town, 60)
    names = connection.scene.names
    assert len(names) == 5
    for index, name in enumerate(names):
        if name == "pillar":
            continue
        walked = town.path_of(name)[-61:]
        wanted = in_town(poses[:, index, 0], poses[:, index, 1], PLACE)
        away = np.hypot(*(walked[:, :2] - wanted).T)
        assert away.max() < (0.001 if drift == 0 else 0.03)
        assert np.hypot(*(wanted[-1] - wanted[0])) > 2
        moves = wanted[1:] - wanted[:-1]
        going = np.hypot(*moves.T) > 0.05
        courses = np.degrees(np.arctan2(moves[:, 1], moves[:, 0]))
        assert np.abs(np.remainder(walked[1:, 2] - courses + 180, 360) - 180)[going].max() < (0.2 if drift == 0 else 10)
    assert connection.bridges[0].corrections == 0
    spawned = {event["blueprint"] for event in town.events("spawn")}
    assert spawned == {"walker.pedestrian.0001", "walker.pedestrian.0002"}
    town.check_clean()


def test_one_batch_and_one_tick_in_each_step(stand_in: StartTown) -> None:
    town = stand_in()
    _walk(town, 20)
    batches = town.events("batch")
    assert [event["kinds"] for event in batches[:-1]] == [[4] * 4] * 20
    assert batches[-1]["kinds"] == [1] * 4
    frames = [event["frame"] for event in batches[:-1]]
    assert np.diff(frames).tolist() == [1] * 19
    (settings,) = [event["settings"] for event in town.events("settings")[:1]]
    assert settings[:3] == [True, False, [True, 0.1]]


def test_a_pedestrian_that_falls_behind_is_put_back(stand_in: StartTown) -> None:
    town = stand_in(drift=0.9)
    poses, connection = _walk(town, 40, ", correction: 0.3")
    assert connection.bridges[0].corrections == len(town.events("transform")) > 10
    walked = town.path_of("guide")[-41:]
    wanted = in_town(poses[:, 0, 0], poses[:, 0, 1], PLACE)
    assert np.hypot(*(walked[:, :2] - wanted).T).max() < 0.45  # the distance of a correction, and one step
    for event in town.events("transform"):
        assert event["pose"][0][2] == pytest.approx(event["before"][2])  # on the ground, where it was
    town.check_clean()


def test_short_ticks_in_long_steps(stand_in: StartTown) -> None:
    town = stand_in()
    poses, connection = _walk(town, 10, ", tick: 0.05, rendering: false")
    assert connection.bridges[0].ticks == 20 + 10  # and half a second to fall
    walked = town.path_of("guide")[-21::2]
    np.testing.assert_allclose(walked[:, :2], in_town(poses[:, 0, 0], poses[:, 0, 1], PLACE), atol=1e-3)
    assert town.events("settings")[0]["settings"][:3] == [True, True, [True, 0.05]]
    town.check_clean()


def test_a_town_with_roads(stand_in: StartTown) -> None:
    town = stand_in(road=LEFT_CURVE, ground=-5.0)
    text = CROWD.format(port=town.port, timeout=5, more=", town: StandInTown, ground: road")
    env = environment(text.replace("x: 100, y: -50, yaw: 30", "x: 0, y: 10, yaw: 0"))
    with irsim.connect(env):
        env.step()
    assert {event["pose"][0][2] for event in town.events("spawn")} == {0.5}  # above the road, not above the ground


YARD_AT = (-20.0, 35.0, -70.0)
CAR = {
    "drive": "acker", "shape": "{name: rectangle, length: 3.0, width: 1.4, wheelbase: 2.0}", "state": "[2, 2, 0]",
    "goal": "[9, 6]", "vel_max": "[1.5, 0.6]", "vel_min": "[-1.5, -0.6]",
}  # fmt: skip
CART = {**CAR, "drive": "diff", "shape": "{name: circle, radius: 0.3}", "vel_max": "[1.2, 1]", "vel_min": "[-1.2, -1]"}
WALL = in_town(YARD[:, 0], YARD[:, 1], YARD_AT).tolist()


def in_yard(town: StandIn, more: str, kind: dict[str, str]) -> irsim.Env:
    wall = [list(map(float, point)) for point in YARD]
    return environment(DRIVE.format(port=town.port, more=more, wall=wall, **kind))


class Drive:
    """A run of the car in the yard: its poses, what irsim measures where it is, and what its policy got."""

    def __init__(self, town: StandIn, steps: int, more: str, kind: dict[str, str]) -> None:
        env = in_yard(town, more, kind)
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


def middle_of_car(run: Drive) -> Any:
    """(T, 2) of CARLA; the middle is a metre ahead of the rear axle."""
    x, y, yaw = run.pose.T
    return in_town(x + np.cos(yaw), y + np.sin(yaw), YARD_AT)


def _smooth(ranges: Any) -> Any:
    """Beams whose neighbours hit the same surface."""
    bent = np.abs(np.diff(ranges, n=2, axis=1)) < 0.1
    return np.pad(bent, ((0, 0), (1, 1)))


@pytest.mark.parametrize("mount", ["", ", channels: 8, upper: 10, lower: -30, height: 1.2"])
def test_points_become_the_scan_that_irsim_measures(stand_in: StartTown, mount: str) -> None:
    town = stand_in(walls=[WALL], ground=0.4)
    more = f", vehicles: [car], command: velocity, lidar: {{robots: [car]{mount}}}"
    run = Drive(town, 50, more, CART)
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


def test_a_walker_sees_in_the_direction_of_its_object(stand_in: StartTown) -> None:
    run = Drive(stand_in(walls=[WALL]), 40, ", lidar: {}", CART)
    assert run.connection.bridges[0].agents == set()
    away = np.abs(run.seen - run.own)
    assert np.abs(np.diff(run.pose[:, 2])).max() > 0.05  # it turns, and looks where it will walk
    assert away[_smooth(run.own)].max() < 0.02
    assert (away > 0.02).mean() < 0.02


def test_a_scan_differs_without_the_town(stand_in: StartTown) -> None:
    run = Drive(stand_in(), 5, ", vehicles: [car], command: velocity, lidar: {}", CART)
    assert (run.own < 9).mean() > 0.8
    assert (run.seen < 9).mean() < 0.1  # the town has no wall: what the policy sees is what CARLA measures


def test_a_left_turn_is_a_left_turn(stand_in: StartTown) -> None:
    town = stand_in(walls=[WALL])
    run = Drive(town, 25, "", CAR)
    first = town.events("ackermann")[1]
    assert run.pose[25, 2] > 0.3  # counterclockwise in irsim
    assert first["steer"] == pytest.approx(-math.atan2(4, 7), abs=1e-3)  # negative is left in CARLA
    assert 0.5 < first["speed"] <= 1.5
    town_path = town.path_of("car")[-26:]
    assert np.all(np.diff(town_path[:, 2])[1:6] < 0)  # and its yaw falls
    np.testing.assert_allclose(town_path[:, :2], middle_of_car(run), atol=1e-3)
    yaw = YARD_AT[2] - np.degrees(run.pose[:, 2])
    assert np.abs(np.remainder(town_path[:, 2] - yaw + 180, 360) - 180).max() < 0.01
    assert run.connection.bridges[0].agents == {"car"}
    town.check_clean()


def test_the_steering_angle_is_that_of_the_vehicle(stand_in: StartTown) -> None:
    town = stand_in()
    Drive(town, 3, ", wheelbase: 3", CAR)
    assert town.events("ackermann")[1]["steer"] == pytest.approx(-math.atan(1.5 * 4 / 7), abs=1e-3)


def test_velocities_cross_with_their_signs(stand_in: StartTown) -> None:
    town = stand_in()
    run = Drive(town, 12, ", vehicles: [car], command: velocity", CART)
    turn = town.events("turn")[0]["rate"]
    assert run.pose[12, 2] > 0.3
    assert turn[:2] == [0, 0]
    assert turn[2] < -20  # counterclockwise is negative in CARLA, in degrees
    path = town.path_of("car")[-13:]
    np.testing.assert_allclose(path[:, :2], in_town(run.pose[:, 0], run.pose[:, 1], YARD_AT), atol=1e-3)
    moved = run.pose[12, :2] - run.pose[11, :2]
    velocity = town.events("velocity")[11]["velocity"][:2]
    np.testing.assert_allclose(velocity, (in_town(*moved, (0, 0, YARD_AT[2]))) / 0.1, atol=1e-3)


def test_the_scenario_moves_vehicles_too(stand_in: StartTown) -> None:
    town = stand_in(ground=0.7)
    run = Drive(town, 20, ", command: transform, vehicle_blueprint: vehicle.micro.*", CAR)
    assert run.connection.bridges[0].agents == set()
    path = town.path_of("car")[-21:]
    np.testing.assert_allclose(path[:, :2], middle_of_car(run), atol=1e-3)
    assert {round(event["pose"][0][2], 3) for event in town.events("transform")} == {0.7}
    assert "vehicle.micro.microlino" in {event["blueprint"] for event in town.events("spawn")}
    town.check_clean()


def test_an_object_follows_an_actor_of_others(stand_in: StartTown) -> None:
    other = in_town(np.array(3.0), np.array(4.0), YARD_AT).tolist()
    others = [["traffic", "vehicle.tesla.model3", *other, -20.0]]
    town = stand_in(others=others, others_do=["velocity", 1.0, 0.5])
    run = Drive(town, 20, ", vehicles: [], walkers: [walker], follow: {car: traffic}", CART)
    assert run.connection.bridges[0].agents == {"car"}
    number = "21"
    places = np.array([e["places"][number][1:] for e in town.events("tick")])[-20:]
    np.testing.assert_allclose(places[:, :2], in_town(run.pose[1:, 0], run.pose[1:, 1], YARD_AT), atol=1e-3)
    assert np.hypot(*(places[-1] - places[0])[:2]) > 2
    assert np.radians(-(places[:, 3] - YARD_AT[2])) == pytest.approx(run.pose[1:, 2], abs=1e-3)
    assert run.env.simulation.twist[0, :2] == pytest.approx(
        np.linalg.solve(in_town(*np.eye(2), (0, 0, YARD_AT[2])).T, [1.0, 0.5]), abs=1e-2
    )
    assert 21 not in {event["id"] for event in town.events("destroy")}
    town.check_clean()


def test_a_reset_puts_all_actors_back(stand_in: StartTown) -> None:
    town = stand_in(walls=[WALL])
    env = in_yard(town, "", CAR)
    with irsim.connect(env):
        for _ in range(10):
            env.step()
        env.reset()
        env.step()
    car = town.path_of("car")
    start = in_town(np.array(3.0), np.array(2.0), YARD_AT)
    assert np.hypot(*(car[-1, :2] - start)) < 0.2
    assert np.hypot(*(car[-2, :2] - start)) < 0.01
    town.check_clean()
