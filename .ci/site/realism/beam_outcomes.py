"""Readings of beams on one wall against the mixture of a beam's outcomes."""

from __future__ import annotations

import math

import numpy as np
import yaml

from realism.simulated import opened
from realism.validation import Curve, Validation

__all__ = ["validation"]

WORLDS = 100
WIDTH = 0.1
"""Width of the bars of the histogram [m]."""
NEAR = 3.0
"""Range below which readings are counted [m]."""


def validation(text: str) -> Validation:
    """All beams meet a wall at the same range."""
    scene = yaml.safe_load(text)
    [sensor], [wall] = scene["robot"]["sensors"], scene["obstacle"]
    true = wall["state"][0] - wall["shape"]["length"] / 2 - scene["robot"]["state"][0]
    real, std, most = sensor["realism"], sensor["std"], sensor["range_max"]
    short, rate, anything = real["short_share"], real["short_rate"], real["random_share"]
    hits = 1 - real["dropout"] - short - anything
    batch = opened(text, WORLDS)
    valid = batch.simulation.valid.reshape(batch.ranges.shape) == 1
    count, edges = np.histogram(batch.ranges[valid], np.arange(0, most + WIDTH / 2, WIDTH))
    middle, total = (edges[:-1] + edges[1:]) / 2, batch.ranges.size
    share = count / total / WIDTH
    z = np.linspace(0, most, 2001)
    bell = np.exp(-0.5 * ((z - true) / std) ** 2) / (std * math.sqrt(2 * math.pi))
    cut = np.where(z < true, rate * np.exp(-rate * z) / (1 - math.exp(-rate * true)), 0.0)
    law = short * (1 - math.exp(-rate * NEAR)) / (1 - math.exp(-rate * true)) + anything * NEAR / most
    return Validation(
        x="reading [m]",
        y="density [1/m]",
        points=(Curve("simulated", middle[count > 0], share[count > 0]),),
        lines=(Curve("mixture of the outcomes", z, hits * bell + short * cut + anything / most),),
        quantity=f"Share of readings below {NEAR:g} m",
        measured=float(np.mean(valid & (batch.ranges < NEAR))),
        expected=law,
        tolerance=4 * math.sqrt(law * (1 - law) / total),
        unit="",
        setup=f"{total:,} beams on a wall at {true:g} m.",
        logarithmic="y",
    )
