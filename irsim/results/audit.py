"""Typed results of ``irsim audit``."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from irsim.results.base import Result
from irsim.results.findings import Finding

__all__ = [
    "AuditCheck",
    "AuditFinding",
    "AuditResult",
    "AuditedRobot",
    "LeaderboardRow",
    "NearContact",
    "RunAudit",
    "SubmissionAudit",
]

Value = float | int | bool | str | list[float | None] | None
"""A recorded or recomputed value."""


class AuditCheck(Result):
    """One kind of comparison."""

    name: str
    """``motion``, ``limits``, ``contacts``, ``arrivals``, ``outcome``, ``metrics``; of a submission also others."""
    status: Literal["equal", "different", "not_checked"]
    """Whether everything that was compared is equal within the tolerances."""
    compared: int
    """Number of values that were compared."""
    differences: int
    """Number of them that differ."""
    note: str = ""
    """The parts that were left out, and why; else empty."""


class AuditFinding(Result):
    """A place at which a record and what is recomputed from it differ."""

    code: str
    """Code; ``irsim describe CODE`` explains it."""
    object: str | None = None
    """Name of the object."""
    partner: str | None = None
    """Name of the other object of a contact."""
    step: int | None = None
    """Step; 0 is the initial state."""
    recorded: Value = None
    """The value in the record."""
    recomputed: Value = None
    """The value that the audit has computed."""
    tolerance: float | None = None
    """Difference up to which the two count as equal, in the unit of the values."""
    message: str
    """The difference in one sentence."""


class NearContact(Result):
    """A contact that the record does not decide, because the two touch within the tolerance."""

    object: str
    """Name of the first object."""
    partner: str
    """Name of the second object."""
    step: int
    """Step."""
    gap: float
    """Distance of the two [m]; 0 or less if they touch."""
    note: str
    """Whether the record has this contact."""


class AuditedRobot(Result):
    """The numbers that the audit has computed for one robot."""

    name: str
    """Name."""
    outcome: Literal["success", "collision", "timeout"]
    """Its outcome."""
    time_to_goal: float | None
    """Time of its first arrival [s]; None if it did not arrive."""
    path_length: float
    """Distance that it travelled in the whole run [m]."""
    path_to_goal: float
    """Distance that it travelled until it arrived, or to the end [m]."""
    mean_speed: float | None
    """Distance travelled until it arrived, divided by the time that took [m/s]."""
    min_clearance: float | None
    """Smallest distance to any other object at the ends of steps until it arrived [m]; below 0: overlap."""
    nearest: str | None
    """Name of the object at that distance."""
    contacts: int
    """Number of its contacts that count as collisions."""
    contacts_between_steps: int
    """Number of its contacts that began and ended within one step."""


class RunAudit(Result):
    """The result of ``irsim audit`` for one recorded run."""

    run: str
    """The run, as it was named."""
    equal: bool
    """Whether the record could be read, and everything that was compared is equal."""
    summary: str
    """One sentence."""
    outcome: Literal["success", "collision", "timeout"] | None = None
    """The recomputed outcome; None if the run has no robots or has not ended."""
    steps: int = 0
    """Number of steps."""
    objects: int = 0
    """Number of objects."""
    checks: list[AuditCheck] = Field(default_factory=list)
    """The kinds of comparisons."""
    problems: list[Finding] = Field(default_factory=list)
    """Why the record cannot be read; empty if it can."""
    findings: list[AuditFinding] = Field(default_factory=list)
    """Where the record differs, the first 50."""
    finding_count: int = 0
    """Number of differences."""
    within_tolerance: list[NearContact] = Field(default_factory=list)
    """Contacts within the tolerance of touching, the first 50."""
    within_tolerance_count: int = 0
    """Number of such contacts."""
    tolerance: float = 0.0
    """Distance within which contacts cannot be decided [m]."""
    unseen_depth: float = 0.0
    """How deep two bodies can have overlapped within a step without being seen [m]: the bound of the subdivision."""
    robots: list[AuditedRobot] = Field(default_factory=list)
    """The computed numbers of each robot."""
    version: str = ""
    """Version of irsim that recorded the run."""


class LeaderboardRow(Result):
    """A row of a leaderboard: one policy under one summary of a suite."""

    suite: str
    """Name, version and hash of the suite."""
    scenes: str
    """The scenarios that are summarised."""
    policy: str
    """The policy."""
    episodes: int
    """Number of episodes."""
    success: float
    """Share of successful episodes."""
    low: float | None
    """Lower end of its 95 % interval; None where nothing is random."""
    high: float | None
    """Upper end of it."""
    collision: float
    """Share of episodes with a collision."""
    time_to_goal: float | None
    """Mean time of robots that arrived [s]."""
    replayed: int = 0
    """Number of episodes of this policy, in any scenario, that the audit has run again."""


class SubmissionAudit(Result):
    """The result of ``irsim audit`` for a submission."""

    folder: str
    """The folder, as it was named."""
    equal: bool
    """Whether nothing was found."""
    summary: str
    """One sentence."""
    episodes: int = 0
    """Number of rows."""
    sampled: int = 0
    """Number of recorded episodes that were audited and compared with the suite and with their rows."""
    unchecked: int = 0
    """Number of rows that are the word of the submitter: this audit has neither a record of them nor ran them again.
    Rates are made of all rows."""
    engine: str = ""
    """Identity of the engine that ran it, as it says."""
    replayed: int = 0
    """Number of episodes that were run again."""
    salt: str = ""
    """The text that has drawn them; the same text draws the same episodes. Empty if none were run again."""
    not_replayed: list[str] = Field(default_factory=list)
    """Drawn episodes that could not be run again, and why, in words."""
    notes: list[str] = Field(default_factory=list)
    """Other comparisons that were left out, in words."""
    problems: list[Finding] = Field(default_factory=list)
    """Everything that is wrong, the first 50, each with the file that it is about."""
    problem_count: int = 0
    """Number of problems."""
    runs: list[RunAudit] = Field(default_factory=list)
    """The audits of the recorded episodes that have differences."""
    leaderboard: list[LeaderboardRow] = Field(default_factory=list)
    """The rows of a leaderboard, recomputed from the rows of the submission; empty if there are problems."""


class AuditResult(Result):
    """The result of ``irsim audit``."""

    equal: bool
    """Whether everything is equal in everything that was audited."""
    summary: str
    """One sentence."""
    runs: list[RunAudit]
    """The recorded runs, in the order in which they were named."""
    submissions: list[SubmissionAudit] = Field(default_factory=list)
    """The submissions, in the order in which they were named."""
