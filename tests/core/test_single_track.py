"""The single track of a car: CommonRoad's derivatives, fine integration, stability at any speed, and driving."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

import irsim._core as core
from irsim.components.kinematics._presets import VEHICLES
from tests.core.driving import EXACT, driven, fine
from tests.core.worlds import assert_success, robot, scene

G = 9.81
KINDS = list(VEHICLES)


def car(vehicle: str = "bmw_320i", **options: Any) -> core.SingleTrackOptions:
    values = dict(VEHICLES[vehicle].values)
    usual = {
        "noise": False, "alpha": [0.03, 0.0, 0.0, 0.03], "model": "dynamic", "tyres": "saturating", "mode": "steer",
        "wheelbase": values["front"] + values["rear"],
    }  # fmt: skip
    return core.SingleTrackOptions(**{**usual, **values, **options})


def at(speed: float, steer: float = 0.0, yaw: float = 0.0, slip: float = 0.0) -> list[float]:
    return [0.0, 0.0, 0.0, steer, speed, yaw, slip]


def test_derivatives_are_those_of_commonroad() -> None:
    """Published test vectors of vehicle 2, by acceleration and steering rate."""
    kinematic = core.single_track_rates(
        car(model="kinematic"),
        [0.0378491427211811, 16.3546957860883566, 0.0294717351052816, 0.0, 0.0],
        0.15,
        0.63 * G,
    )
    expected = [16.3475935934250209, 0.4819314886013121, 0.15, 5.1464424102339752, 0.2401426578627629]
    assert kinematic == pytest.approx(expected, abs=1e-12)
    for tyres in ("linear", "saturating"):
        dynamic = core.single_track_rates(
            car(tyres=tyres),
            [0.0197545248559617, 15.7216236334290116, 0.0025857914776859, 0.0529001056654038, 0.0033012170610298],
            0.15,
            0.63 * G,
        )
        expected = [15.7213512030862397, 0.0925527979719355, 0.15, 5.3536773276413925, 0.0529001056654038,
                    0.6435589397748606, 0.0313297971641291]  # fmt: skip
        assert dynamic == pytest.approx(expected, abs=1e-12)


def test_the_limits_of_commonroad() -> None:
    drive, most = car(), VEHICLES["bmw_320i"].values
    rates = core.single_track_rates(drive, [1.066, 20.0, 0.0, 0.0, 0.0], 9.0, 99.0)
    assert (rates[2], rates[3]) == (0.0, pytest.approx(most["acce_max"] * most["speed_switch"] / 20.0))
    rates = core.single_track_rates(drive, [-1.066, 50.8, 0.0, 0.0, 0.0], 9.0, 99.0)
    assert (rates[2], rates[3]) == (0.4, 0.0)
    rates = core.single_track_rates(drive, [0.0, -13.9, 0.0, 0.0, 0.0], -9.0, -99.0)
    assert (rates[2], rates[3]) == (-0.4, 0.0)


@pytest.mark.parametrize("vehicle", KINDS)
@pytest.mark.parametrize("speed", [2.0, 5.0, 12.0])
def test_the_steady_yaw_rate_understeers_as_tyres_and_load_say(vehicle: str, speed: float) -> None:
    p = VEHICLES[vehicle].values
    length = p["front"] + p["rear"]
    # Slip of front minus rear tyres per lateral acceleration: 1 / (friction * stiffness * g) of each axle.
    gradient = (1 / p["stiffness_front"] - 1 / p["stiffness_rear"]) / (p["friction"] * G)
    psi = 0.004
    path = driven(car(vehicle), at(speed, psi), [[speed, psi]] * 300)
    assert path[-1, 5] / psi == pytest.approx(speed / (length + gradient * speed**2), rel=1e-3)


@pytest.mark.parametrize("vehicle", KINDS)
@pytest.mark.parametrize("psi", [0.2, -0.35])
def test_a_constant_angle_gives_a_circle(vehicle: str, psi: float) -> None:
    for drive, speed in ((car(vehicle, model="kinematic"), 3.0), (car(vehicle), 0.45)):
        path = driven(drive, at(speed, psi), [[speed, psi]] * 200)
        radius = (VEHICLES[vehicle].values["front"] + VEHICLES[vehicle].values["rear"]) / math.tan(psi)
        if drive.model == "kinematic":
            assert np.hypot(path[:, 0], path[:, 1] - radius) == pytest.approx(abs(radius), abs=1e-6)
        else:  # the speed is at the centre of mass, and the yaw rate follows it: the rear axle is on the circle
            assert np.hypot(path[5:, 0], path[5:, 1] - radius) == pytest.approx(abs(radius), abs=1e-6)


def commonroad(p: Any, speed_law: Any) -> Any:
    """Right-hand side of the dynamic model about the centre of mass, with linear tyres, written out."""
    length = p["front"] + p["rear"]
    lf, lr, h, m, inertia = p["front"], p["rear"], p["height"], p["mass"], p["inertia"]

    def rates(y: np.ndarray, u: Sequence[float]) -> np.ndarray:
        _, _, heading, psi, v, yaw, slip = y
        turn = float(np.clip(u[1], -p["steer_rate"], p["steer_rate"]))
        a = speed_law(v, u[0])
        front, rear = p["stiffness_front"] * (G * lr - a * h), p["stiffness_rear"] * (G * lf + a * h)
        k = p["friction"] * m / (inertia * length)
        yaw_rate = -k / v * (lf**2 * front + lr**2 * rear) * yaw + k * (lr * rear - lf * front) * slip
        side = p["friction"] / (v * length)
        slip_rate = (side / v * (rear * lr - front * lf) - 1) * yaw - side * (rear + front) * slip + side * front * psi
        return np.array([v * math.cos(heading + slip), v * math.sin(heading + slip), yaw, turn, a,
                         yaw_rate + k * lf * front * psi, slip_rate])  # fmt: skip

    return rates


@pytest.mark.parametrize(("vehicle", "speed"), [("bmw_320i", 12.0), ("f1tenth", 4.0), ("vw_vanagon", 20.0)])
def test_ten_seconds_are_those_of_fine_integration(vehicle: str, speed: float) -> None:
    p = VEHICLES[vehicle].values
    time = 0.1 * np.arange(100)
    swing = 0.02 if vehicle != "f1tenth" else 0.1
    controls = np.column_stack([1.2 * np.cos(0.7 * time), swing * np.cos(1.3 * time)]).tolist()
    drive = car(vehicle, mode="acceleration", tyres="linear")
    ours = driven(drive, at(speed), controls)
    start = at(speed)
    start[0] = p["rear"]
    exact = fine(commonroad(p, lambda v, a: a), start, controls, parts=50)
    rear = exact[:, :2] - p["rear"] * np.column_stack([np.cos(exact[:, 2]), np.sin(exact[:, 2])])
    assert np.abs(ours[:, :2] - rear).max() < 1e-3
    assert np.abs(ours[:, 3:5] - exact[:, 3:5]).max() < 1e-9
    assert np.abs(ours[:, 5:] - exact[:, 5:]).max() < 1e-3


@pytest.mark.parametrize("dt", [0.1, 0.2])
@pytest.mark.parametrize("model", ["kinematic", "dynamic"])
@pytest.mark.parametrize("vehicle", KINDS)
def test_it_is_stable_at_any_speed(vehicle: str, model: str, dt: float) -> None:
    """Up to top speed and back through rest into reverse, while the wheels swing from stop to stop."""
    p = VEHICLES[vehicle].values
    rng = np.random.default_rng(5)
    for tyres in ("saturating", "linear"):
        for wanted in np.linspace(p["speed_min"], p["speed_max"], 9):
            controls = [[float(wanted), float(rng.choice([-1, 0, 1]) * p["psi_max"])] for _ in range(60)]
            path = driven(car(vehicle, model=model, tyres=tyres), at(0.0), [*controls, *[[0.0, 0.1]] * 60], dt)
            assert np.isfinite(path).all()
            assert path[:, 4].max() <= p["speed_max"] + 1e-9
            assert path[:, 4].min() >= p["speed_min"] - 1e-9
            assert path[-1, 4] == 0.0
            np.testing.assert_allclose(path[-1, :3], path[-2, :3], atol=1e-12)
    for speed in np.linspace(0.1, p["speed_max"], 60):
        psi = min(0.05, 0.5 * p["friction"] * G * (p["front"] + p["rear"]) / speed**2)  # asks for half the grip
        path = driven(car(vehicle, model=model), at(float(speed), psi), [[float(speed), psi]] * 40, dt)
        assert np.abs(path[:, 6]).max() < 0.15
        assert np.ptp(path[-10:, 5]) < 1e-3 * np.abs(path[:, 5]).max(), "it drives a circle"


@pytest.mark.parametrize("vehicle", KINDS)
@pytest.mark.parametrize("psi", [0.0, 0.03, 0.3])
@pytest.mark.parametrize("speed", [3.0, 12.0, 19.0])
def test_energy_never_grows_when_braking(vehicle: str, psi: float, speed: float) -> None:
    """Nor in a spin: with full brakes in a curve the rear tyres lose their load, and slide."""
    p = VEHICLES[vehicle].values
    before = driven(car(vehicle), at(speed, psi), [[speed, psi]] * 50)[-1].tolist()
    path = driven(car(vehicle), before, [[0.0, psi]] * 60, 0.05)
    energy = 0.5 * p["mass"] * path[:, 4] ** 2 + 0.5 * p["inertia"] * path[:, 5] ** 2
    assert (np.diff(energy) <= 1e-9).all()
    assert energy[-1] == 0.0


def test_speed_and_angle_are_followed_within_their_limits() -> None:
    path = driven(car("f1tenth"), at(0.0), [[5.0, 0.3]] * 10)
    assert path[:, 4] == pytest.approx(np.minimum(5.0, 9.51 * 0.1 * np.arange(11)))
    assert path[1, 3] == 0.3
    slow = driven(car("bmw_320i"), at(0.0), [[5.0, 0.3]] * 10)
    assert slow[:, 3] == pytest.approx(np.minimum(0.3, 0.04 * np.arange(11)))


def test_sliding_tyres_give_no_more_than_friction_times_load() -> None:
    drive = car("bmw_320i")
    rates = core.single_track_rates(drive, [0.5, 20.0, 0.0, 0.0, 0.0], 0.0, 0.0)
    p = VEHICLES["bmw_320i"].values
    load = p["friction"] * G * p["rear"] / (p["front"] + p["rear"])
    assert rates[6] == pytest.approx(load / 20.0)
    assert rates[5] == pytest.approx(load * p["front"] * p["mass"] / p["inertia"])


def test_from_wheels_that_roll_to_tyres_that_slip_there_is_no_jump() -> None:
    path = driven(car("f1tenth"), at(0.0, 0.2), [[2.0, 0.2]] * 200, 0.01)
    yaw = np.diff(np.unwrap(path[:, 2])) / 0.01
    p = VEHICLES["f1tenth"].values
    rolling = path[1:, 4] * math.tan(0.2) / (p["front"] + p["rear"])
    slow = path[1:, 4] < 0.45
    assert yaw[slow] == pytest.approx(rolling[slow], abs=0.2)
    assert np.abs(np.diff(yaw)).max() < 0.1


def test_one_world_of_a_batch_is_that_world_alone() -> None:
    def run(seeds: list[int]) -> np.ndarray:
        drive = core.SingleTrackOptions(**{
            name: getattr(car("f1tenth"), name) for name in core.SingleTrackOptions.fields
        } | {"noise": True})  # fmt: skip
        world, state = scene(robot(drive=drive, goals=[[8, 8, 0]], vel_max=[3, 1, 1], acce=[4, math.inf, 1]),
                             seeds=seeds)  # fmt: skip
        world.integration = EXACT
        core.advance(world, state, 60, threads=2)
        return np.column_stack([state.pose, state.extra])

    together = run([3, 4, 5])
    assert together[1].tobytes() == run([4])[0].tobytes()
    assert not np.array_equal(together[0], together[1])


TRACK = """
world: {width: 30, height: 16, step_time: 0.1, integration: exact, time_limit: 60}
robot:
  name: car
  kinematics: {name: single_track, vehicle: f1tenth%s}
  shape: {name: rectangle, length: 0.58, width: 0.31, wheelbase: 0.33}
  state: [2, 2, 1.2]
  goal: [27, 13, 0]
  goal_threshold: 0.4
  vel_max: [3, 0.4]
  vel_min: [-1, -0.4]
  behavior: %s
obstacle:
  - {shape: {name: rectangle, length: 0.5, width: 10}, state: [10, 5, 0]}
  - {shape: {name: rectangle, length: 0.5, width: 10}, state: [20, 11, 0]}
"""


@pytest.mark.parametrize("local", ["dash", "orca", "rvo", "sfm", "avocado", "footprint_orca"])
def test_it_follows_a_planned_path_between_walls(local: str) -> None:
    assert_success(TRACK % ("", f"{{name: follow, local: {{name: {local}}}}}"), seed=1)


def test_it_drives_by_steering_rate() -> None:
    options = ", mode: angular, model: kinematic"
    text = (TRACK % (options, "{name: follow}")).replace("3, 0.4]", "2, 3]").replace("-1, -0.4]", "-1, -3]")
    assert_success(text, seed=1)
