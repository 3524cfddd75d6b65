"""Spread of the error of localization over time against its closed form, with gross errors."""

from __future__ import annotations

import math

import numpy as np
import yaml

from irsim.components.sensors.localization import Localization
from realism.simulated import driven, opened, readings
from realism.validation import Curve, Validation

__all__ = ["validation"]

WORLDS, DURATION, SPEED = 3000, 30.0, 1.0
SETTLED = 10.0
"""Time from which on the spread is measured [s]."""


def validation(text: str) -> Validation:
    """Many robots drive straight ahead."""
    scene = yaml.safe_load(text)
    sensor, dt, batch = Localization(**scene["robot"]["sensors"][0]), scene["world"]["step_time"], opened(text, WORLDS)
    spread = []
    for _ in driven(batch, [SPEED, 0.0], round(DURATION / dt)):
        spread.append(float(np.std(readings(batch)[:, :2] - batch.pose[:, 0, :2])))
    time = dt * np.arange(1, len(spread) + 1)
    apart = dt * math.ceil(sensor.min_distance / (SPEED * dt) - 1e-9)  # time between corrections, in whole steps
    kept = math.exp(-2 * apart / sensor.time)  # share of the variance of an error that the next correction has
    chance = 1 - math.exp(-sensor.jumps_per_km * SPEED * apart / 1000)
    corrections = np.floor(time / apart + 1e-6)
    jumps = chance * sensor.jump_std**2 * (1 - kept**corrections) / (1 - kept)
    law = np.sqrt(sensor.position_std**2 + jumps)
    late = time >= SETTLED
    expected = float(np.sqrt(np.mean(law[late] ** 2)))
    return Validation(
        x="time [s]",
        y="deviation of a coordinate [m]",
        points=(Curve("simulated", time[4::5], np.array(spread)[4::5]),),
        lines=(
            Curve("corrections and gross errors", time, law),
            Curve("position_std", [0, DURATION], 2 * [sensor.position_std], 3, faint=True),
        ),
        quantity=f"Standard deviation after {SETTLED:g} s",
        measured=float(np.sqrt(np.mean(np.square(spread)[late]))),
        expected=expected,
        tolerance=0.05 * expected,
        unit="m",
        setup=f"{WORLDS:,} robots drive at {SPEED:g} m/s; gross errors add up until as many fade as come.",
    )
