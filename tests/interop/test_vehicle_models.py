"""The single track of a car against CommonRoad's own vehicle models, which have the same cars."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import irsim._core as core
from irsim.components.kinematics._presets import VEHICLES
from tests.core.driving import driven, fine
from tests.core.test_single_track import at, car

pytestmark = pytest.mark.interop
NUMBERS = {"ford_escort": 1, "bmw_320i": 2, "vw_vanagon": 3}


def theirs(vehicle: str, model: str) -> Any:
    """Their parameters of a car, and their right-hand side."""
    name = f"parameters_vehicle{NUMBERS[vehicle]}"
    parameters = getattr(pytest.importorskip(f"vehiclemodels.{name}"), name)()
    dynamics = pytest.importorskip(f"vehiclemodels.vehicle_dynamics_{model}")
    return parameters, getattr(dynamics, f"vehicle_dynamics_{model}")


@pytest.mark.parametrize("vehicle", NUMBERS)
def test_derivatives_are_theirs(vehicle: str) -> None:
    p = VEHICLES[vehicle].values
    rng = np.random.default_rng(NUMBERS[vehicle])
    models = [(*theirs(vehicle, "ks"), "kinematic", 5), (*theirs(vehicle, "st"), "dynamic", 7)]
    for _ in range(500):
        steer, speed = rng.uniform(-1.2, 1.2) * p["psi_max"], rng.uniform(1.0, 1.05 * p["speed_max"])
        steer = min(max(steer, -p["psi_max"]), p["psi_max"])
        heading, yaw, slip = rng.uniform(-3, 3), rng.uniform(-1, 1), rng.uniform(-0.2, 0.2)
        rate, gain = rng.uniform(-0.6, 0.6), rng.uniform(-15, 15)
        for parameters, rates, ours, size in models:
            state = [0.0, 0.0, steer, speed, heading, yaw, slip][:size]
            drive = car(vehicle, model=ours, tyres="linear")
            computed = core.single_track_rates(drive, [steer, speed, heading, yaw, slip], rate, gain)
            np.testing.assert_allclose(computed, rates(state, [rate, gain], parameters), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("vehicle", NUMBERS)
def test_ten_seconds_are_theirs(vehicle: str) -> None:
    parameters, rates = theirs(vehicle, "st")
    time = 0.1 * np.arange(100)
    controls = np.column_stack([1.5 * np.cos(0.5 * time), 0.02 * np.cos(1.1 * time)]).tolist()

    def reordered(y: np.ndarray, u: Any) -> np.ndarray:
        x, y_, heading, steer, speed, yaw, slip = y
        f = rates([x, y_, steer, speed, heading, yaw, slip], [u[1], u[0]], parameters)
        return np.array([f[0], f[1], f[4], f[2], f[3], f[5], f[6]])

    start = at(10.0)
    start[0] = parameters.b
    exact = fine(reordered, start, controls, parts=20)
    rear = exact[:, :2] - parameters.b * np.column_stack([np.cos(exact[:, 2]), np.sin(exact[:, 2])])
    ours = driven(car(vehicle, mode="acceleration", tyres="linear"), at(10.0), controls)
    assert np.abs(ours[:, :2] - rear).max() < 1e-3
