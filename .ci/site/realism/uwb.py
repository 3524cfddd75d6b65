"""Ranges to radio anchors behind walls against what each wall adds."""

from __future__ import annotations

import math

import numpy as np
import yaml

from realism.simulated import driven, opened, readings
from realism.validation import Curve, Validation

__all__ = ["validation"]

WORLDS, STEPS = 200, 50


def validation(text: str) -> Validation:
    """A robot at rest; anchor k is behind k walls."""
    scene = yaml.safe_load(text)
    [sensor], batch = scene["robot"]["sensors"], opened(text, WORLDS)
    ranges = np.concatenate([readings(batch) for _ in driven(batch, [0.0, 0.0], STEPS)])
    exact = np.hypot(*(np.array(sensor["anchors"], float) - scene["robot"]["state"][:2]).T)
    errors, walls = ranges - exact, np.arange(len(exact))
    bias, spread = errors.mean(axis=0), errors.std(axis=0)
    fine = np.linspace(0, len(exact) - 1, 101)
    expected = sensor["nlos_bias"] * 2
    deviation = math.hypot(sensor["std"], math.sqrt(2) * sensor["nlos_std"])
    return Validation(
        x="walls on the way",
        y="error of a range [m]",
        points=(Curve("mean", walls, bias), Curve("standard deviation", walls, spread, 1)),
        lines=(
            Curve("n · nlos_bias", fine, sensor["nlos_bias"] * fine),
            Curve("√(std² + n · nlos_std²)", fine, np.sqrt(sensor["std"] ** 2 + fine * sensor["nlos_std"] ** 2), 1),
        ),
        quantity="Mean error behind two walls",
        measured=float(bias[2]),
        expected=expected,
        tolerance=4 * deviation / math.sqrt(len(errors)),
        unit="m",
        setup=f"{len(errors):,} ranges to each of {len(exact)} anchors.",
    )
