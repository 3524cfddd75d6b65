"""Readings of a sonar that looks at a wall askance against the nearest point in its cone."""

from __future__ import annotations

import math

import numpy as np
import yaml

from realism.simulated import opened, readings
from realism.validation import Curve, Validation

__all__ = ["validation"]

ASKEW = 30
"""Angle at which the reading is measured [degrees]."""


def validation(text: str) -> Validation:
    """One run for each heading towards the wall."""
    scene = yaml.safe_load(text)
    [sensor], [wall] = scene["robot"]["sensors"], scene["obstacle"]
    x, y, _ = scene["robot"]["state"]
    away = wall["state"][0] - wall["shape"]["length"] / 2 - x
    half, most = sensor["cone"] / 2, sensor["incidence_max"]
    degrees = np.arange(-60, 61, 5)
    ranges = []
    for heading in np.radians(degrees).tolist():
        [read] = readings(opened({**scene, "robot": {**scene["robot"], "state": [x, y, heading]}}))
        ranges.append(read[0] if read[1] else math.nan)
    fine = np.linspace(-60, 60, 481)
    beyond = np.maximum(0.0, np.abs(np.radians(fine)) - half)
    law = np.where(beyond <= most, away / np.cos(beyond), math.nan)
    expected = away / math.cos(math.radians(ASKEW) - half)
    return Validation(
        x="angle between the axis and the normal of the wall [°]",
        y="reading [m]",
        points=(Curve("simulated", degrees, ranges),),
        lines=(Curve("D / cos(|a| − cone / 2)", fine, law),),
        quantity=f"Reading at {ASKEW}°",
        measured=float(ranges[degrees.tolist().index(ASKEW)]),
        expected=expected,
        tolerance=1e-6,
        unit="m",
        setup=(
            f"A wall {away:g} m away; within half the cone the nearest point is ahead of it, and more than "
            f"{math.degrees(half + most):.0f}° aslant it gives no echo."
        ),
    )
