"""Readings of a triangulating range sensor, which folds near surfaces back, against its curve."""

from __future__ import annotations

import numpy as np
import yaml

from realism.simulated import opened, readings
from realism.validation import Curve, Validation

__all__ = ["validation"]

WORLDS = 100


def validation(text: str) -> Validation:
    """One run for each distance of the wall."""
    scene = yaml.safe_load(text)
    [sensor], [wall] = scene["robot"]["sensors"], scene["obstacle"]
    least, most = sensor["range_min"], sensor["range_max"]
    distances = np.concatenate([np.arange(0.03, 0.1, 0.01), np.arange(0.1, 0.85, 0.05)])
    means = []
    for distance in distances.tolist():
        x = scene["robot"]["state"][0] + sensor["offset"][0] + distance + wall["shape"]["length"] / 2
        batch = opened({**scene, "obstacle": [{**wall, "state": [x, *wall["state"][1:]]}]}, WORLDS)
        means.append(float(readings(batch)[:, 0].mean()))
    fine = np.linspace(0.025, 0.85, 331)
    law = np.minimum(most, np.where(fine < least, least**2 / fine, fine))
    at = int(np.argmin(np.abs(distances - 0.05)))
    expected = least**2 / 0.05
    return Validation(
        x="distance of the wall [m]",
        y="mean reading [m]",
        points=(Curve("simulated", distances, means),),
        lines=(
            Curve("r, and range_min² / r below range_min", fine, law),
            Curve("without folds", fine[fine < least], fine[fine < least], 3, faint=True),
        ),
        quantity="Mean reading at 0.05 m",
        measured=means[at],
        expected=expected,
        tolerance=4 * sensor["std_per_meter"] * expected / WORLDS**0.5,
        unit="m",
        setup=f"Means of {WORLDS} readings at each distance of a wall.",
    )
