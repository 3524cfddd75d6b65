"""The typed result of ``irsim.validate``: findings, repairs, the comparison and the dry run."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from irsim.results.base import Result
from irsim.results.episode import EventRecord, Left
from irsim.results.findings import Finding

__all__ = ["CommentChange", "DryRun", "Fix", "KeyChange", "ScenarioDiff", "Stuck", "ValidationReport", "WorldChange"]


class Fix(Result):
    """A repair that was made."""

    code: str
    path: str
    line: int | None
    change: str
    """The repair: ``renamed 'behaviour' to 'behavior'``."""


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
    """The result of a dry run: the first steps, of which no record is kept."""

    seed: int
    random: list[str]
    """Parts that the seed decides; empty if every seed gives the same run."""
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
    """The result of ``irsim validate`` for one scenario."""

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
    edge; for a map ``map_columns``, ``map_rows``, unless the seed decides them ``map_occupied`` cells, and
    ``map_unknown`` ones if there are any."""
    fixes: list[Fix] = Field(default_factory=list)
    """Repairs that were made; ``findings`` has what remains."""
    changes: ScenarioDiff | None = None
    """Differences from the scenario compared with."""
    dry_run: DryRun | None = None
    """The result of the dry run."""


class KeyChange(Result):
    """A key that differs between two files."""

    change: Literal["added", "removed", "changed", "moved"]
    """``moved``: an entry whose place in its list changed; ``before`` and ``after`` are the two places."""
    path: str
    """Its path in the new file; in the old file if it was removed."""
    before: Any = None
    after: Any = None


class WorldChange(Result):
    """A fact that differs between two worlds."""

    object: str | None
    """Name of the object in the new world; None for the world itself."""
    change: Literal["added", "removed", "changed"]
    key: str | None = None
    """Which of its facts: ``pose``, ``sensors[0].number``."""
    before: Any = None
    after: Any = None
    direct: bool = False
    """Whether it only repeats a changed key; texts for people then show only the key."""


class CommentChange(Result):
    """A comment that was edited."""

    before: str
    after: str


class ScenarioDiff(Result):
    """The result of ``irsim diff``."""

    before: str
    after: str
    same: bool
    """True if neither a key nor a fact differs; comments and layout may differ."""
    summary: str
    keys: list[KeyChange]
    """Changes of the files; entries are matched by name or similarity when others are added or removed before them."""
    world: list[WorldChange] | None
    """Changes of the worlds, which are built with the same seed; None if one of the scenarios is invalid."""
    motion: list[str] | None = None
    """Differences in motion when both are tried with the same seed, collisions first; empty if everything moves alike,
    None if that was not compared."""
    comments_lost: list[str]
    """Comments that were removed; edited ones are in ``comments_changed``."""
    comments_changed: list[CommentChange]
    """Comments that were edited."""
    lines_removed: int
    lines_added: int
