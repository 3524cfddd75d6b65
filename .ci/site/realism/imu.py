"""Allan deviation of a gyroscope at rest, beside the law of white noise with a wandering bias."""

from __future__ import annotations

import numpy as np
import yaml

from irsim.common.arrays import Floats
from irsim.components.sensors.imu import Imu
from realism.simulated import driven, opened, readings
from realism.validation import Curve, Validation
from tests.core.estimators import allan

__all__ = ["validation"]

WORLDS, STEPS = 32, 9_000


def _law(sensor: Imu, time: Floats) -> Floats:
    """(K,) deviations [rad/s] for averaging times [s]: white noise, and a first-order Gauss-Markov process."""
    share = sensor.gyro_drift_time / time
    fading = 3 - 4 * np.exp(-1 / share) + np.exp(-2 / share)
    drift = 2 * sensor.gyro_drift_std**2 * share * (1 - share / 2 * fading)
    deviation: Floats = np.sqrt(sensor.gyro_noise**2 / time + drift)
    return deviation


def validation(text: str) -> Validation:
    """Many robots rest for 20 minutes."""
    scene = yaml.safe_load(text)
    sensor, dt, batch = Imu(**scene["robot"]["sensors"][0]), scene["world"]["step_time"], opened(text, WORLDS)
    rates = np.array([readings(batch)[:, 0] for _ in driven(batch, [0.0, 0.0], STEPS)])
    groups = np.unique(np.round(np.geomspace(1, 2000, 18)).astype(int)).tolist()
    time = dt * np.array(groups)
    deviation = allan(rates, dt, groups)
    fine = np.geomspace(time[0], time[-1], 101)
    soon = time <= 1.0
    return Validation(
        x="averaging time [s]",
        y="Allan deviation [rad/s]",
        points=(Curve("simulated", time, deviation),),
        lines=(
            Curve("noise and wandering bias", fine, _law(sensor, fine)),
            Curve("noise alone: slope −1/2", fine, sensor.gyro_noise / np.sqrt(fine), 3, faint=True),
        ),
        quantity="Slope up to 1 s",
        measured=float(np.polyfit(np.log(time[soon]), np.log(deviation[soon]), 1)[0]),
        expected=-0.5,
        tolerance=0.02,
        unit="",
        setup=f"{WORLDS} gyroscopes at rest for {STEPS * dt / 60:g} minutes.",
        logarithmic="xy",
    )
