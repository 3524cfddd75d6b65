"""Fits options of behaviors to recorded people: ``python -m tests.benchmarks.pedestrians.fit FOLDER NAME...``.

A search without derivatives: steps of random direction and shrinking length, in octaves, from the defaults, of which
those are kept that make people more human. It is seeded, so the same recording gives the same options; what it found is
in ``irsim/components/behaviors/_people.py``.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from irsim.bridges.pedestrians.cases import Cases, read_cases
from irsim.bridges.pedestrians.imitation import RADIUS, imitate
from irsim.bridges.pedestrians.likeness import Likeness, contacts, likeness
from irsim.options.registry import BEHAVIORS
from tests.benchmarks.pedestrians.human import FILES

BOUNDS: dict[str, dict[str, tuple[float, float]]] = {
    "sfm": {
        "relaxation_time": (0.1, 4.0),
        "force_factor_social": (0.1, 20.0),
        "lambda_importance": (0.25, 8.0),
        "gamma": (0.05, 2.0),
        "n_angular": (0.25, 8.0),
        "n_velocity": (0.25, 8.0),
    },
    "orca": {"timeHorizon": (0.25, 20.0), "safe_radius": (0.005, 0.4), "neighborDist": (1.0, 15.0)},
}
"""Options that are fitted, and their least and greatest value."""
EVERY = 4
"""Every fourth case counts while options are sought: cases of one person begin 0.4 s apart and are much alike."""
TRIALS = 120
FIRST_STEP, LAST_STEP = 1.0, 0.1
"""Standard deviation of a step at the start and at the end [octaves]."""


def distance(alike: Likeness, recorded: float) -> float:
    """How far people are from real ones: ADE [m], distances to the nearest other [m], and contacts, 1 m for all.

    Args:
        alike: How alike they are.
        recorded: Share of people who touch others in the recording.
    """
    return alike.ade + alike.nearest + abs(alike.contacts - recorded)


def judge(cases: Cases, behavior: str, options: Mapping[str, float]) -> tuple[Likeness, float]:
    """How alike people with these options are who know where they want to go, and how far they are from real ones."""
    walks = imitate(cases, {"name": behavior, **options}, cases.goal)
    alike = likeness(cases, walks, RADIUS)
    return alike, distance(alike, contacts(cases, cases.truth, RADIUS))


def defaults(behavior: str) -> dict[str, float]:
    """The defaults of the options that are fitted."""
    feature = BEHAVIORS.get(behavior)
    assert feature is not None
    return {key: float(feature.options.model_fields[key].default) for key in BOUNDS[behavior]}


def fit(cases: Cases, behavior: str, trials: int = TRIALS, seed: int = 0) -> dict[str, float]:
    """The options that make people most human in a recording, with three digits."""
    some = every(cases, EVERY)
    rng = np.random.default_rng(seed)
    best = defaults(behavior)
    least = judge(some, behavior, best)[1]
    for trial in range(trials):
        size = FIRST_STEP * (LAST_STEP / FIRST_STEP) ** (trial / trials)
        steps = dict(zip(best, rng.normal(0.0, size, len(best)).tolist(), strict=True))
        other = {key: _within(value * 2.0 ** steps[key], *BOUNDS[behavior][key]) for key, value in best.items()}
        distance = judge(some, behavior, other)[1]
        if distance < least:
            best, least = other, distance
    return best


def every(cases: Cases, step: int) -> Cases:
    """Every ``step``-th case."""
    some = slice(None, None, step)
    return replace(
        cases,
        seen=cases.seen[some],
        truth=cases.truth[some],
        goal=cases.goal[some],
        scene=cases.scene[some],
        column=cases.column[some],
    )


def _within(value: float, low: float, high: float) -> float:
    return float(f"{min(max(value, low), high):.3g}")


if __name__ == "__main__":
    for name in sys.argv[2:] or FILES:
        people = read_cases(Path(sys.argv[1]) / FILES[name])
        for behavior in BOUNDS:
            print(name, behavior, fit(people, behavior), flush=True)
