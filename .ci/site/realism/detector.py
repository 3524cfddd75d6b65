"""Share of looks in which a detector sees a person, beside the logistic curve of the distance."""

from __future__ import annotations

import math

import numpy as np
import yaml

from realism.simulated import driven, opened, readings
from realism.validation import Curve, Validation

__all__ = ["validation"]

WORLDS, STEPS = 50, 60
DISTANCES = np.linspace(1.5, 10.5, 13)
"""Distances of the people [m]; each stands in a direction of its own, so that no person hides another."""
COLUMNS = 7
"""Numbers of a track, of which the last one is the number of the object."""


def validation(text: str) -> Validation:
    """A robot looks at people who stand still around it."""
    scene = yaml.safe_load(text)
    [sensor], [person] = scene["robot"]["sensors"], scene["obstacle"]
    x, y = scene["robot"]["state"][:2]
    turns = 2 * math.pi * np.arange(len(DISTANCES)) / len(DISTANCES)
    places = np.column_stack([x + DISTANCES * np.cos(turns), y + DISTANCES * np.sin(turns)])
    people = [{**person, "state": [*place, 0.0], "behavior": None} for place in places.tolist()]
    batch = opened({**scene, "obstacle": people}, WORLDS)
    seen = np.zeros(len(people))
    for _ in driven(batch, [0.0, 0.0], STEPS):
        tracks = readings(batch).reshape(WORLDS, -1, COLUMNS)[..., -1]
        seen += [np.count_nonzero(tracks == number) for number in range(1, len(people) + 1)]
    looks = WORLDS * STEPS
    near, half, soft = sensor["probability"], sensor["half_range"], sensor["range_softness"]
    fine = np.linspace(0, 11, 221)
    at = int(np.argmin(np.abs(DISTANCES - half)))
    expected = near / (1 + math.exp((DISTANCES[at] - half) / soft))
    return Validation(
        x="distance [m]",
        y="share of looks with a detection",
        points=(Curve("simulated", DISTANCES, seen / looks),),
        lines=(
            Curve(
                "probability / (1 + exp((d − half_range) / softness))", fine, near / (1 + np.exp((fine - half) / soft))
            ),
        ),
        quantity=f"Share at {DISTANCES[at]:g} m",
        measured=float(seen[at]) / looks,
        expected=expected,
        tolerance=4 * math.sqrt(expected * (1 - expected) / looks),
        unit="",
        setup=f"{len(people)} people around a robot, {looks:,} looks at each.",
    )
