"""Autocovariance of the error of satellite navigation against noise with a Gauss-Markov process."""

from __future__ import annotations

import numpy as np
import yaml

from realism.simulated import driven, opened, readings
from realism.validation import Curve, Validation

__all__ = ["validation"]

WORLDS, STEPS = 2000, 240


def validation(text: str) -> Validation:
    """Many robots rest and read their position once a second."""
    scene = yaml.safe_load(text)
    [sensor], batch = scene["robot"]["sensors"], opened(text, WORLDS)
    dt = scene["world"]["step_time"]
    errors = np.array([readings(batch)[:, :2] - batch.pose[:, 0, :2] for _ in driven(batch, [0.0, 0.0], STEPS)])
    lags = np.array([0, *range(1, 121, 7)])
    kept = np.array([float(np.mean(errors[lag:] * errors[: len(errors) - lag])) for lag in lags])
    drift, time = sensor["drift_std"], sensor["drift_time"]
    fine = np.linspace(0, 120, 121)
    slope = np.polyfit(dt * lags[1:10], np.log(kept[1:10]), 1)[0]
    return Validation(
        x="lag [s]",
        y="autocovariance of a coordinate [m²]",
        points=(Curve("simulated", dt * lags, kept),),
        lines=(
            Curve("drift_std² · exp(−lag / drift_time)", fine, drift**2 * np.exp(-fine / time)),
            Curve("drift_std² + std² at a lag of 0", [0, 4], 2 * [drift**2 + sensor["std"] ** 2], 3, faint=True),
        ),
        quantity="Time in which the error forgets itself",
        measured=-1 / float(slope),
        expected=time,
        tolerance=0.05 * time,
        unit="s",
        setup=f"{WORLDS:,} receivers at rest, a reading in each of {STEPS} seconds.",
    )
