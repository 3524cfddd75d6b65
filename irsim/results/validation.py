"""The typed result of ``irsim.validate``: findings, repairs, the comparison and the dry run."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from irsim.results.base import Result
from irsim.results.diff import ScenarioDiff
from irsim.results.findings import Finding
from irsim.results.run import EventRecord, Left

__all__ = ["DryRun", "Fix", "Stuck", "ValidationReport"]


class Fix(Result):
    """A repair that was made."""

    code: str
    path: str
    line: int | None
    change: str
    """What was done: ``renamed 'behaviour' to 'behavior'``."""


class Stuck(Result):
    """A robot that gets nowhere."""

    name: str
    doing: Literal["stands", "circles its goal"] = "stands"
    since: float
    """When it began [s]."""
    x: float
    y: float
    why: str


class DryRun(Result):
    """What happened in a first look: some steps, nothing kept."""

    seed: int
    random: list[str]
    """What the seed decides; empty if every seed gives the same."""
    steps: int
    sim_time: float
    """Simulated time [s]."""
    ended: Literal["done", "horizon", "budget"]
    """``done``: every robot arrived or stopped; ``horizon``: the episode was over; ``budget``: the work of a look was
    done, which is estimated from the scenario, so the same steps are tried on every machine (``summary`` says so if it
    was the clock after all)."""
    summary: str
    arrived: list[str]
    """Robots that reached their last goal."""
    collisions: list[EventRecord]
    """The first ones, in order."""
    stuck: list[Stuck]
    """The first ones; ``summary`` has how many there are."""
    left: list[Left]
    parked: list[str] = Field(default_factory=list)
    """Robots that cannot move and have no goal of their own."""
    jammed: list[str] = Field(default_factory=list)
    """Moving obstacles that stand at the end since they hit another obstacle."""


class ValidationReport(Result):
    """What ``irsim validate`` found in one file."""

    file: str
    """The file, or the name given to a text."""
    valid: bool
    """No errors."""
    summary: str
    """One line: what the scenario holds, or how much is wrong with it."""
    errors: int
    """How many errors."""
    warnings: int
    """How many warnings."""
    hints: int
    """How many hints."""
    findings: list[Finding]
    """All findings, errors first."""
    counts: dict[str, int] = Field(default_factory=dict)
    """Robots, obstacles (those of entries) and sensors of a valid scenario; ``boundary`` if there are walls round it;
    of a map ``map_columns``, ``map_rows`` and, unless the seed decides, ``map_occupied`` cells."""
    fixes: list[Fix] = Field(default_factory=list)
    """Repairs that were made; the findings are those that are left."""
    changes: ScenarioDiff | None = None
    """What differs from the scenario it was compared with."""
    dry_run: DryRun | None = None
    """What happened when it was tried."""
