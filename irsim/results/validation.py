"""The typed result of ``irsim.validate``: findings, repairs, the comparison and the dry run."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from irsim.results.base import Result
from irsim.results.diff import ScenarioDiff
from irsim.results.episode import EventRecord, Left
from irsim.results.findings import Finding

__all__ = ["DryRun", "Fix", "Stuck", "ValidationReport"]


class Fix(Result):
    """A repair that was made."""

    code: str
    path: str
    line: int | None
    change: str
    """What was done: ``renamed 'behaviour' to 'behavior'``."""


class Stuck(Result):
    """A robot that makes no progress."""

    name: str
    doing: Literal["stands", "circles its goal"] = "stands"
    since: float
    """Time when it began [s]."""
    x: float
    y: float
    why: str


class DryRun(Result):
    """What happened in a dry run: the first steps, of which no record is kept."""

    seed: int
    random: list[str]
    """What the seed decides; empty if every seed gives the same run."""
    steps: int
    sim_time: float
    """Simulated time [s]."""
    ended: Literal["done", "horizon", "budget"]
    """``done``: every robot arrived or stopped; ``horizon``: the time limit was reached; ``budget``: the work allowed
    for a dry run was used up. That work is estimated from the scenario, so every machine runs the same number of
    steps; ``summary`` says so if the clock ended it instead."""
    summary: str
    arrived: list[str]
    """Robots that reached their last goal."""
    collisions: list[EventRecord]
    """The first collisions, in order."""
    contacts_between_steps: list[EventRecord] = Field(default_factory=list)
    """The first contacts of robots that began and ended within one step, in order."""
    stuck: list[Stuck]
    """The first stuck robots; ``summary`` has their number."""
    left: list[Left]
    parked: list[str] = Field(default_factory=list)
    """Robots that cannot move and have no goal of their own."""
    jammed: list[str] = Field(default_factory=list)
    """Moving obstacles that a collision with another obstacle has stopped."""


class ValidationReport(Result):
    """What ``irsim validate`` found in one scenario."""

    file: str
    """The file, or the name given to a text."""
    valid: bool
    """True if there are no errors."""
    summary: str
    """One line: what the scenario contains, or how many problems it has."""
    errors: int
    """Number of errors."""
    warnings: int
    """Number of warnings."""
    hints: int
    """Number of hints."""
    findings: list[Finding]
    """All findings, errors first."""
    counts: dict[str, int] = Field(default_factory=dict)
    """Number of robots, obstacles (from entries) and sensors of a valid scenario; ``boundary`` if it has walls at the
    edge; for a map ``map_columns``, ``map_rows`` and, unless the seed decides them, ``map_occupied`` cells."""
    fixes: list[Fix] = Field(default_factory=list)
    """Repairs that were made; ``findings`` has what remains."""
    changes: ScenarioDiff | None = None
    """Differences from the scenario compared with."""
    dry_run: DryRun | None = None
    """What happened in the dry run."""
