"""The way of wheels and the way of the body on slippery ground."""

from __future__ import annotations

import numpy as np
import yaml

from realism.simulated import driven, opened, readings
from realism.validation import Curve, Validation

__all__ = ["validation"]

WAY = 2.0
"""Distance by which the wheels turn in each run [m]."""


def validation(text: str) -> Validation:
    """One run straight ahead for each slip of the ground."""
    scene = yaml.safe_load(text)
    slips = np.linspace(0.0, 0.9, 10)
    ways, believed = [], []
    for slip in slips.tolist():
        [zone] = scene["world"]["zones"]
        batch = opened({**scene, "world": {**scene["world"], "zones": [{**zone, "slip": slip}]}})
        start = batch.pose[0, 0, 0].copy()
        for _ in driven(batch, [0.5, 0.0], round(WAY / 0.5 / 0.1)):
            pass
        ways.append(batch.pose[0, 0, 0] - start)
        believed.append(readings(batch)[0, 0] - start)
    return Validation(
        x="slip of the zone",
        y="way [m]",
        points=(Curve("body", slips, ways), Curve("odometry", slips, believed, 1)),
        lines=(Curve("(1 − s) · turn of the wheels", slips, WAY * (1 - slips)), Curve("", slips, WAY + 0 * slips, 1)),
        quantity="Way of the body at a slip of 0.2",
        measured=float(ways[2]),
        expected=0.8 * WAY,
        tolerance=1e-9,
        unit="m",
        setup=f"A robot with two wheels drives straight ahead until each wheel has turned by {WAY:g} m.",
    )
