"""Scatter of a lidar by range against the line of its data sheet."""

from __future__ import annotations

import math

import numpy as np
import yaml

from realism.simulated import opened
from realism.validation import Curve, Validation

__all__ = ["validation"]

WORLDS = 60
BINS = 12


def validation(text: str) -> Validation:
    """Scans of a wall beside scans of the same wall without errors."""
    scene = yaml.safe_load(text)
    [sensor] = scene["robot"]["sensors"]
    std, growth = sensor["std"], sensor["realism"]["std_per_meter"]
    plain = {**sensor, "noise": False, "realism": None}
    exact = opened({**scene, "robot": {**scene["robot"], "sensors": [plain]}}).ranges[0]
    errors = opened(text, WORLDS).ranges - exact
    seen = exact < sensor["range_max"]
    ranges, errors = exact[seen], errors[:, seen]
    edges = np.linspace(ranges.min(), ranges.max(), BINS + 1)
    inside = np.clip(np.digitize(ranges, edges) - 1, 0, BINS - 1)
    middle = [float(ranges[inside == k].mean()) for k in range(BINS)]
    scatter = [float(np.sqrt(np.mean(errors[:, inside == k] ** 2))) for k in range(BINS)]
    law = std**2 + (growth * ranges) ** 2
    slope = np.polyfit(ranges**2, np.mean(errors**2, axis=0), 1, w=1 / law)[0]
    fine = np.linspace(0, edges[-1] * 1.05, 101)
    return Validation(
        x="range [m]",
        y="standard deviation [m]",
        points=(Curve("simulated", middle, scatter),),
        lines=(Curve("√(std² + (std_per_meter · r)²)", fine, np.hypot(std, growth * fine)),),
        quantity="Growth of the standard deviation, by regression",
        measured=math.sqrt(slope),
        expected=growth,
        tolerance=0.02 * growth,
        unit="",
        setup=f"{errors.size:,} beams on a wall, each beside the same beam without errors.",
    )
