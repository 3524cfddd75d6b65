"""How behaviors walk in the place of recorded people: the numbers of a row, and the kept errors of each case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from irsim.bridges.pedestrians.cases import Cases
from irsim.bridges.pedestrians.comparison import CONSTANT_VELOCITY
from irsim.bridges.pedestrians.imitation import RADIUS, GoalName, goals_of, imitate, keep_velocity
from irsim.bridges.pedestrians.likeness import Likeness, likeness, nearest
from tests.benchmarks.reference.kept import kept_lines, write

__all__ = ["CASES", "KEPT", "Walks", "cells", "constant_velocity", "differences", "keep", "kept_cells", "walks_of"]

KEPT = "pedestrians_cases"
"""Name of the kept file with the errors of each case, see :mod:`tests.benchmarks.reference.kept`."""
CASES = "All cases"
"""The content of the file, in words."""
_HEAD = ("recording", "behavior", "goal", "cases", "ade_mm", "fde_mm", "contacts", "persons")
_RESAMPLES, _SEED = 10_000, 20_230_616
"""Number of draws of persons for an interval, and their seed."""


class Walks(NamedTuple):
    """One behavior in the place of all people of a recording.

    Attributes:
        recording: Name of the recording.
        behavior: The behavior as text.
        goal: Where people want to go, ``recorded`` or ``extrapolated``; empty without a goal.
        likeness: The numbers of a row of the page.
        line: The errors of each case, as they are kept.
    """

    recording: str
    behavior: str
    goal: str
    likeness: Likeness
    line: dict[str, str]


def walks_of(cases: Cases, text: str, behavior: Mapping[str, Any] | None, goal: GoalName | None) -> Walks:
    """Let a behavior walk.

    Args:
        cases: The people of a recording.
        text: The behavior in words.
        behavior: Its name and options; None: people keep their velocity.
        goal: Where people want to go; None without a behavior.
    """
    places = keep_velocity(cases)
    if behavior is not None:
        assert goal is not None
        places = imitate(cases, behavior, goals_of(cases, goal))
    error = np.linalg.norm(places - cases.truth, axis=2)
    touched = (nearest(cases, places) < 2 * RADIUS).any(axis=1)
    line = {
        **dict(zip(_HEAD, (cases.name, text, goal or "", str(len(cases))), strict=False)),
        "ade_mm": " ".join(f"{1000 * value:.0f}" for value in error.mean(axis=1)),
        "fde_mm": " ".join(f"{1000 * value:.0f}" for value in error[:, -1]),
        "contacts": " ".join(map(str, np.flatnonzero(touched))),
    }
    return Walks(cases.name, text, goal or "", likeness(cases, places, RADIUS), line)


def constant_velocity(cases: Cases) -> Walks:
    """People who keep their last known velocity; their line also says which person each case is about."""
    made = walks_of(cases, CONSTANT_VELOCITY, None, None)
    _, person = np.unique(cases.goal, axis=0, return_inverse=True)  # a recording without a gap ends in one place
    made.line["persons"] = " ".join(map(str, person.ravel()))
    return made


def cells(one: Likeness) -> tuple[str, str, str]:
    """ADE [m], FDE [m] and share of contacts as the page has them."""
    return f"{one.ade:.2f}", f"{one.fde:.2f}", f"{one.contacts:.1%}"


def keep(walks: Sequence[Walks]) -> None:
    """Keep the errors of each case."""
    write(KEPT, _HEAD, [one.line for one in walks])


def differences(behavior: str, other: str, goal: str) -> dict[str, tuple[float, float, float]]:
    """Recording → ADE of a behavior minus ADE of another one, in the kept cases, with its 95 % interval [m].

    Persons are resampled with all of their cases, which begin 0.4 s apart and are much alike.

    Args:
        behavior: The behavior in words.
        other: The other one.
        goal: Where people want to go.
    """
    lines = {(line["recording"], line["behavior"], line["goal"]): line for line in kept_lines(KEPT)}
    made = {}
    for recording in dict.fromkeys(recording for recording, *_ in lines):
        first, second = (
            np.array(lines[recording, name, goal]["ade_mm"].split(), dtype=float) / 1000 for name in (behavior, other)
        )
        person = np.array(lines[recording, CONSTANT_VELOCITY, ""]["persons"].split(), dtype=int)
        total, number = np.bincount(person, first - second), np.bincount(person)
        count = len(number)
        drawn = np.random.default_rng(_SEED).multinomial(count, np.full(count, 1 / count), size=_RESAMPLES)
        low, high = np.percentile((drawn @ total) / (drawn @ number), [2.5, 97.5])
        made[recording] = float((first - second).mean()), float(low), float(high)
    return made


def kept_cells() -> dict[tuple[str, str, str], tuple[str, str, str]]:
    """Recording, behavior and goal → ADE, FDE and contacts of the kept cases, as the page has them."""
    made = {}
    for line in kept_lines(KEPT):
        ade, fde = (np.array(line[key].split(), dtype=float) / 1000 for key in ("ade_mm", "fde_mm"))
        touched = len(line["contacts"].split()) / int(line["cases"])
        own = Likeness(len(ade), float(ade.mean()), float(fde.mean()), touched, np.nan, np.nan)
        made[line["recording"], line["behavior"], line["goal"]] = cells(own)
    return made
