"""``randomize.sensor_noise``: a factor on the standard deviations of every kind of sensor; at 0 each one is exact."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from irsim.common.arrays import Floats
from irsim.learning.tasks.files import TaskError
from irsim.learning.worlds import Worlds
from irsim.options.registry import SENSORS
from tests.learning.tasks import task

WALL = {"shape": {"name": "rectangle", "length": 1, "width": 60}, "state": [3.5, 5, 0]}
WALKER = {
    "kinematics": {"name": "omni"},
    "shape": {"name": "circle", "radius": 0.3},
    "behavior": {"name": "dash"},
    "state": [2, 8],
    "goal": [2, 2],
}
REALISM = {"std_per_meter": 0.02, "bias_std": 0.05, "scale_std": 0.05}
BEAMS = {"number": 30, "range_max": 4, "noise": True, "std": 0.05}
BIASES = {"gyro_bias_std": 0.02, "gyro_drift_std": 0.02, "gyro_scale_std": 0.05, "misalignment_std": 0.1}
DRIFT = {"distance_noise": 0.05, "heading_noise": 0.05, "turning_noise": 0.05}
KINDS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "lidar2d": ({"number": 30, "range_max": 4}, {**BEAMS, "realism": REALISM}),
    "fmcw_lidar2d": ({"number": 30, "range_max": 4}, {**BEAMS, "velocity_noise_std": 0.1}),
    "depth_scan": ({"number": 30, "range_max": 4}, {"depth_std": 0.02, "depth_growth": 0.01, "realism": REALISM}),
    "sonar": ({}, {"std": 0.05, "std_per_meter": 0.02}),
    "ir_range": ({}, {"std": 0.05, "std_per_meter": 0.02}),
    "localization": (
        {"position_std": 0, "heading_std": 0},
        {"position_std": 0.1, "heading_std": 0.1, "jumps_per_km": 1e5, "jump_std": 1, **DRIFT},
    ),
    "odometry": ({}, {**DRIFT, "diameter_std": 0.02, "track_std": 0.05, "scale_std": 0.05}),
    "imu": (
        {},
        {**BIASES, "gyro_noise": 0.01, "accel_noise": 0.1, "accel_bias_std": 0.1, "accel_drift_std": 0.1,
         "accel_scale_std": 0.05, "tilt_std": 0.02},
    ),
    "gnss": ({"std": 0, "drift_std": 0}, {"std": 0.5, "drift_std": 1}),
    "uwb": ({}, {"std": 0.1, "nlos_std": 0.2}),
    "detector": ({}, {"position_std": 0.1, "velocity_std": 0.1}),
}  # fmt: skip
"""Kind -> keys of an exact sensor, and keys that add standard deviations to it."""
NEEDED = {"uwb": {"anchors": [[0.5, 9], [9, 1]]}, "ir_range": {"range_max": 4}}
WITHOUT_SPREAD = {"bumper", "cliff", "contact2d"}
"""Kinds of sensors whose errors are shares of readings, or that have no errors."""


def measured(name: str, keys: dict[str, Any], **randomize: Any) -> Floats:
    """Everything that a sensor reports while its robot drives a curve."""
    sensor = {"name": name, **NEEDED.get(name, {}), **keys}
    worlds = Worlds(task({"sensors": [sensor]}, obstacles=[WALL, WALKER], randomize=randomize), 1, seed=5)
    told = []
    for _ in range(8):
        worlds.step(np.array([[0.5, 0.5]]))
        simulation = worlds.simulation
        told.append(np.concatenate([simulation.ranges.ravel(), simulation.state.readings.ravel()]))
    return np.array(told)


def scaled(name: str, factor: float) -> Floats:
    keys = {**KINDS[name][0], **KINDS[name][1]}
    return measured(name, keys, sensor_noise={"learners": [factor, factor]})


def test_every_kind_of_sensor_is_here() -> None:
    assert {feature.name for feature in SENSORS.features()} == {*KINDS, *WITHOUT_SPREAD}


@pytest.mark.parametrize("name", KINDS)
def test_a_factor_of_0_makes_a_sensor_exact(name: str) -> None:
    exact = measured(name, KINDS[name][0])
    assert np.isfinite(exact).any()
    assert scaled(name, 0.0) == pytest.approx(exact, abs=1e-9, nan_ok=True)


@pytest.mark.parametrize("name", KINDS)
def test_a_factor_of_2_doubles_errors(name: str) -> None:
    exact = measured(name, KINDS[name][0])
    errors = [np.nan_to_num(scaled(name, factor) - exact) for factor in (1e-3, 2e-3)]
    moved = np.abs(errors[0]) > 1e-6
    assert moved.any()
    assert errors[1][moved] == pytest.approx(2 * errors[0][moved], rel=0.05, abs=2e-6)


@pytest.mark.parametrize("name", ["lidar2d", "imu", "detector", "cliff"])
def test_noise_that_is_not_there_cannot_be_drawn(name: str) -> None:
    with pytest.raises(TaskError, match=r"no sensor .* is noisy"):
        measured(name, KINDS.get(name, ({}, {}))[0], sensor_noise={"learners": [0, 2]})


def test_the_noise_of_a_lidar_must_be_on() -> None:
    with pytest.raises(TaskError, match=r"no sensor .* is noisy"):
        measured("lidar2d", {"std": 0.1, "angle_std": 0.01}, sensor_noise={"learners": [0, 2]})
    assert measured("lidar2d", {"std": 0.1, "realism": REALISM}, sensor_noise={"learners": [0, 2]}).any()
