"""How human behaviors are: the people of recordings, foretold by each behavior, beside how they really went on."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from irsim.bridges.pedestrians.cases import Cases, read_cases
from irsim.bridges.pedestrians.imitation import GOALS, RADIUS, GoalName, goals_of, imitate, keep_velocity
from irsim.bridges.pedestrians.likeness import Likeness, contacts, likeness
from irsim.common.arguments import check_positive
from irsim.diagnostics.errors import ArgumentError
from irsim.options.registry import BEHAVIORS
from irsim.scenario.behavior_override import parse_behavior

__all__ = ["CONSTANT_VELOCITY", "Compared", "Row", "compare_pedestrians", "rows_of"]

CONSTANT_VELOCITY = "constant velocity"
"""Name of the people who keep their last known velocity."""


@dataclass(frozen=True)
class Row:
    """One behavior in one recording.

    Attributes:
        recording: Name of the recording.
        behavior: The behavior as text, or ``constant velocity``.
        goal: Where people want to go, see :data:`irsim.bridges.pedestrians.imitation.GOALS`; empty without a goal.
        likeness: How alike the foretold and the recorded walks are.
    """

    recording: str
    behavior: str
    goal: str
    likeness: Likeness


@dataclass(frozen=True)
class Compared:
    """Behaviors beside recorded people.

    Attributes:
        rows: A row for each recording, behavior and goal.
        contacts: Recording -> share of its people who overlap another one in the recording itself.
        radius: Radius of each person [m].
    """

    rows: list[Row]
    contacts: dict[str, float]
    radius: float


def compare_pedestrians(
    files: Sequence[str | Path],
    behaviors: Sequence[str] = ("dash", "orca", "sfm"),
    *,
    goals: Sequence[GoalName] = GOALS,
    radius: float = RADIUS,
    progress: Callable[[int, int], None] | None = None,
) -> Compared:
    """Let behaviors walk in the place of each recorded person, among the others as they were recorded.

    Args:
        files: Recordings in metres: ETH's ``obsmat.txt``, or lines ``frame id x y``.
        behaviors: Behaviors as text, such as ``orca`` or ``{name: orca, timeHorizon: 2}``.
        goals: Where people want to go.
        radius: Radius of each person [m].
        progress: Called with the number of rows that are done, and of all.

    Raises:
        BridgeError: A file cannot be used.
        ArgumentError: A behavior cannot be used.
    """
    check_positive(radius=radius)
    options = {text: _behavior(text) for text in behaviors}
    recordings = [read_cases(Path(file)) for file in files]
    rows: list[Row] = []
    for cases in recordings:
        for text, behavior in {CONSTANT_VELOCITY: None, **options}.items():
            rows += rows_of(cases, text, behavior, goals, radius)
            if progress is not None:
                progress(len(rows), len(recordings) * (1 + len(options) * len(goals)))
    return Compared(rows, {cases.name: contacts(cases, cases.truth, radius) for cases in recordings}, radius)


def rows_of(
    cases: Cases,
    text: str,
    behavior: Mapping[str, Any] | None,
    goals: Sequence[GoalName] = GOALS,
    radius: float = RADIUS,
) -> list[Row]:
    """The rows of one behavior in one recording; without a behavior, of people who keep their velocity."""
    if behavior is None:
        return [Row(cases.name, text, "", likeness(cases, keep_velocity(cases), radius))]
    places = {goal: imitate(cases, behavior, goals_of(cases, goal), radius=radius) for goal in goals}
    return [Row(cases.name, text, goal, likeness(cases, walks, radius)) for goal, walks in places.items()]


def _behavior(text: str) -> dict[str, Any]:
    """Name and options of a behavior that drives to a goal.

    Raises:
        ArgumentError: The text names none.
    """
    options = parse_behavior(text)
    feature = BEHAVIORS.get(options["name"]) if options is not None else None
    if options is None or (feature is not None and not getattr(feature.options, "needs_goal", True)):
        raise ArgumentError(f"{text!r} does not lead people to a goal", "give a behavior such as sfm, orca or dash")
    return options
