"""Share of beams that come back from dark surfaces against the logistic curve of the range."""

from __future__ import annotations

import math

import numpy as np
import yaml

from realism.simulated import opened
from realism.validation import Curve, Validation

__all__ = ["validation"]

REFLECTIVITIES = (0.1, 0.3)
"""Of the wall in the runs; the first one is measured."""
DARK, WHITE = 0.1, 0.9
"""Reflectivities at whose ranges half of the beams come back."""


def validation(text: str) -> Validation:
    """One run for each distance of the wall and each reflectivity."""
    scene = yaml.safe_load(text)
    [sensor], [wall] = scene["robot"]["sensors"], scene["obstacle"]
    dark, most, fade = sensor["realism"]["range_dark"], sensor["range_max"], sensor["realism"]["fade"]
    points, lines, halves = [], [], []
    for tone, reflectivity in enumerate(REFLECTIVITIES):
        half = dark * (reflectivity / DARK) ** (math.log(most / dark) / math.log(WHITE / DARK))
        ranges = half + fade * np.linspace(-6, 6, 25)
        shares = []
        for distance in ranges.tolist():
            x = scene["robot"]["state"][0] + distance + wall["shape"]["length"] / 2
            changed = {**wall, "state": [x, *wall["state"][1:]], "reflectivity": reflectivity}
            shares.append(float(np.mean(opened({**scene, "obstacle": [changed]}).simulation.valid)))
        fine = np.linspace(ranges[0], ranges[-1], 201)
        points.append(Curve(f"reflectivity {reflectivity:g}", ranges, shares, tone))
        lines.append(Curve("", fine, 1 / (1 + np.exp((fine - half) / fade)), tone))
        steep = [(r, math.log(p / (1 - p))) for r, p in zip(ranges, shares, strict=True) if 0.02 < p < 0.98]
        slope, at = np.polyfit(*np.transpose(steep), 1)
        halves.append(-at / slope)
    return Validation(
        x="range [m]",
        y="share of beams that come back",
        points=tuple(points),
        lines=tuple(lines),
        quantity=f"Range at which half of the beams come back, reflectivity {REFLECTIVITIES[0]:g}",
        measured=float(halves[0]),
        expected=dark,
        tolerance=0.02,
        unit="m",
        setup=f"{sensor['number']:,} beams on a wall at each of {len(ranges)} distances; lines are the logistic curve.",
    )
