"""Typed results of ``irsim.validate``, ``irsim.run``, ``irsim.render``, …: what the CLI prints and ``--json`` dumps."""

from __future__ import annotations

import re
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from irsim.options.base import field_docs

__all__ = [
    "BenchmarkResult",
    "BenchmarkRow",
    "CommentChange",
    "DryRun",
    "Edit",
    "EpisodeRow",
    "Estimate",
    "EventRecord",
    "Finding",
    "Fix",
    "HorizonSource",
    "KeyChange",
    "Left",
    "MovingPose",
    "Proportion",
    "RenderResult",
    "ReplayResult",
    "RobotPlan",
    "RobotPose",
    "RobotResult",
    "RunResult",
    "RunTable",
    "ScenarioDiff",
    "SnapshotResult",
    "Stuck",
    "ValidationReport",
    "WorldChange",
]


HorizonSource = Literal["argument", "scenario", "default", "limits"]
"""Who says how long a run may last."""


_UNUSUAL = re.compile(r"[^\n -~]")


def _escaped(found: re.Match[str]) -> str:
    """A character as it is or, if it is not printable, as the units of UTF-16 that JSON escapes."""
    if found[0].isprintable():
        return found[0]
    units = found[0].encode("utf-16-be").hex()
    return "".join(f"\\u{units[start : start + 4]}" for start in range(0, len(units), 4))


class Result(BaseModel):
    """Base of all results: fields are documented, nothing else gets in.

    As with :class:`irsim.options.base.Options`, the documentation is read on demand, because every command and every
    tool call starts with this module. Models are built at once: pydantic would otherwise read the local variables of
    the first caller, and CPython 3.13.0 crashes on some of these.
    """

    model_config = ConfigDict(extra="forbid")

    def model_dump_json(self, **options: Any) -> str:
        """The result as JSON, the same bytes in Python, ``--json`` and MCP; what is not printable is escaped.

        Args:
            **options: Those of pydantic, such as ``indent``.
        """
        text = super().model_dump_json(**options)
        return text if text.isprintable() else _UNUSUAL.sub(_escaped, text)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        produced = handler(schema)
        properties = handler.resolve_ref_schema(produced).get("properties", {})
        for name, text in field_docs(cls).items():
            if name in properties:
                properties[name].setdefault("description", text)
        return produced


class Edit(Result):
    """A repair that a program can make without guessing."""

    action: Literal["remove", "replace", "rename", "add"]
    path: str
    """What to remove, replace or rename, or the key to add."""
    value: Any = None
    """The new value, or the new name of a key."""


class Finding(Result):
    """One diagnostic."""

    code: str
    """Name in the closed list of codes; ``irsim describe CODE`` explains it."""
    severity: Literal["error", "warning", "hint"]
    """``error``: will not run as asked; ``warning``: runs, but likely not what was meant; ``hint``: worth knowing."""
    path: str
    """Where in the document: ``robot[0].behavior.name``."""
    line: int | None
    """Line in the file, from 1."""
    column: int | None
    """Column in the line, from 1."""
    length: int = 1
    """Characters that are meant, from there."""
    message: str
    """What is wrong."""
    given: Any = None
    """The value as written; of a long one the beginning, as text."""
    allowed: list[str] | str | None = None
    """What would be accepted."""
    fix: str | None = None
    """What to write instead."""
    edit: Edit | None = None
    """The same for programs, where nothing has to be guessed; ``irsim validate --fix`` makes it."""
    tolerated: bool = False
    """Whether ``irsim run`` goes on in spite of it, as IR-SIM does."""
    in_base: bool | None = None
    """Whether the scenario it was compared with has it too; None without one."""


class EventRecord(Result):
    """Something that happened in an episode."""

    kind: Literal["arrival", "waypoint", "collision", "no_path"]
    """``collision`` is reported when contact begins; ``no_path`` when ``follow`` finds none."""
    time: float
    """Simulated time [s]."""
    step: int
    """Steps executed; 0 is the initial state."""
    object: str
    """Name of the object, or of the first of the two that touch."""
    partner: str | None
    """Name of the other one in a collision."""
    x: float
    """Where [m]."""
    y: float
    """Where [m]."""


class Fix(Result):
    """A repair that was made."""

    code: str
    path: str
    line: int | None
    change: str
    """What was done: ``renamed 'behaviour' to 'behavior'``."""


class KeyChange(Result):
    """A key that differs between two files."""

    change: Literal["added", "removed", "changed", "moved"]
    """``moved``: an entry that stands before or after others now; ``before`` and ``after`` are its places."""
    path: str
    """Where it is now; where it was if it was removed."""
    before: Any = None
    after: Any = None


class WorldChange(Result):
    """A fact that differs between two worlds."""

    object: str | None
    """Name of the object (its new one); None for the world itself."""
    change: Literal["added", "removed", "changed"]
    key: str | None = None
    """Which fact of it: ``pose``, ``sensors[0].number``."""
    before: Any = None
    after: Any = None
    direct: bool = False
    """It is what a changed key says, no more; lists for people have only the key."""


class CommentChange(Result):
    """A comment that was edited."""

    before: str
    after: str


class ScenarioDiff(Result):
    """What ``irsim diff`` found."""

    before: str
    after: str
    same: bool
    """Neither a key nor a fact differs; comments and layout may."""
    summary: str
    keys: list[KeyChange]
    """Changes of the files; entries are recognised by name or likeness when others come or go before them."""
    world: list[WorldChange] | None
    """Changes of the worlds, both built with one seed; None if one of the scenarios is invalid."""
    comments_lost: list[str]
    """Comments that are gone; one that says something else now is not among them."""
    comments_changed: list[CommentChange]
    """Comments that were edited."""
    lines_removed: int
    lines_added: int


class Stuck(Result):
    """A robot that gets nowhere."""

    name: str
    doing: Literal["stands", "circles its goal"] = "stands"
    since: float
    """When it began [s]."""
    x: float
    y: float
    why: str


class Left(Result):
    """An object that left the world."""

    name: str
    time: float
    """When [s]."""
    x: float
    y: float


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


class RobotResult(Result):
    """How the episode ended for one robot."""

    name: str
    outcome: Literal["success", "collision", "timeout"]
    """Exactly one: arrived without a collision before; stopped by a collision, or arrived after one; neither."""
    time_to_goal: float | None
    """Time of first arrival [s]; None when it never arrived."""
    collision_count: int
    """Contacts that began."""
    infeasible_steps: int | None = None
    """Steps in which its behavior found no velocity that avoids everybody (only ``orca`` says so); None
    if there were none."""
    path_length: float
    """Distance travelled [m], to the end of the run."""
    distance_to_goal: float | None
    """Distance to the present goal at the end [m]; None without a goal."""
    min_clearance: float | None = None
    """Least distance to anything it could hit, until it arrived, edge to edge [m]; negative: overlap; None where there
    is nothing, and in runs of more than two million poses."""
    nearest: str | None = None
    """Name of what that was."""
    pose: tuple[float, float, float]
    """x, y [m] and heading [rad] at the end."""


class RunResult(Result):
    """What ``irsim run`` did."""

    scenario: str
    """The file."""
    seed: int
    """Seed that was used."""
    random: list[str]
    """What the seed decides; empty if every seed gives the same run."""
    behavior: str | None = None
    """What every robot followed instead of its own behavior; None: the scenario as written."""
    outcome: Literal["success", "collision", "timeout"]
    """``success`` when every robot succeeded, ``collision`` when any collided, otherwise ``timeout``."""
    summary: str
    """One sentence: who arrived, who did not and why."""
    reason: str | None = None
    """Why it is no success: the first collision, and what robots that did not arrive were doing; None if it is one."""
    steps: int
    """Executed steps."""
    sim_time: float
    """Simulated time [s]."""
    time_limit: float
    """Horizon [s]: from the file, from ``--steps``, or max(30 s, 4 x longest way / top speed)."""
    time_limit_from: HorizonSource
    """Where the horizon comes from; ``limits``: cut to the most steps of one run."""
    robots: list[RobotResult]
    """One entry per robot."""
    parked: list[str] = Field(default_factory=list)
    """Robots that cannot move and have no goal of their own; they never arrive."""
    jammed: list[str] = Field(default_factory=list)
    """Moving obstacles that stand at the end since they hit another obstacle."""
    left: list[Left] = Field(default_factory=list)
    """Moving objects whose position left the world, the first ones; ``world.boundary: walls`` keeps them in."""
    events: list[EventRecord]
    """The first events in order; of the arrivals of an object at the same goal only the first."""
    event_count: int
    """How many such events there were."""
    warnings: list[Finding]
    """What is odd about the scenario."""
    files: list[str] = Field(default_factory=list)
    """Files written."""
    version: str
    """Version of irsim."""
    reproduce: str
    """Command that gives the same again."""
    run_id: str | None = None
    """Name of the record of this run, for ``irsim inspect``; None if it was not recorded."""
    artifacts: dict[str, str] = Field(default_factory=dict)
    """Files of the record by name."""
    notes: list[str] = Field(default_factory=list)
    """What the record lacks, because there was too much of it."""


class Estimate(Result):
    """A number over episodes. Episodes in which it is undefined are left out."""

    n: int
    """Episodes it is defined in."""
    mean: float | None = None
    """Mean; None without any."""
    std: float | None = None
    """Standard deviation of the sample; None for fewer than two."""
    low: float | None = None
    """Lower end of the 95 % interval of the mean: bootstrap (10,000 resamples, always the same draws); of metrics that
    are 0 or 1 Wilson, None where nothing is random; of paired shares see ``paired``."""
    high: float | None = None
    """Upper end of it."""


class Proportion(Result):
    """A share of episodes."""

    count: int
    """In how many."""
    n: int
    """Of how many."""
    rate: float
    """Share."""
    low: float | None
    """Lower end of the 95 % interval (Wilson); None where nothing is random: it cannot come out differently."""
    high: float | None
    """Upper end of it."""


class BenchmarkRow(Result):
    """One scenario under one behavior, over all seeds."""

    scenario: str
    """The file; ``(all)`` for all files together, where each has as many episodes, and several or the files are ten."""
    behavior: str
    """What the robots followed: a behavior, or ``as-written``."""
    episodes: int
    """How many."""
    success: Proportion
    """Every robot reached its goal without a collision before."""
    collision: Proportion
    """A robot was stopped by a collision, or arrived after one."""
    timeout: Proportion
    """Neither, at the horizon."""
    metrics: dict[str, Estimate]
    """Metrics of the episodes by key: ``time_to_goal`` [s], ``path_length`` [m], ``velocity_avg`` [m/s], …"""
    paired: dict[str, Estimate] = Field(default_factory=dict)
    """Differences to the first behavior, episode by episode with equal scenario and seed; ``success``, ``collision``
    and ``timeout`` among them. The intervals of such shares are Newcombe's for pairs, which are right also where all
    pairs agree."""
    failed: dict[str, list[int]] = Field(default_factory=dict)
    """Seeds that ended in ``collision`` and in ``timeout``; empty for ``(all)``."""
    failures: dict[str, int] = Field(default_factory=dict)
    """In how many episodes a robot failed in which way, the ten most frequent: ``'car': timeout``; empty for
    ``(all)``."""


class EpisodeRow(Result):
    """One episode of a benchmark."""

    scenario: str
    """The file."""
    behavior: str
    """What the robots followed."""
    seed: int
    """Its seed."""
    outcome: Literal["success", "collision", "timeout"]
    """As in :class:`RunResult`."""
    steps: int
    """Executed steps."""
    sim_time: float
    """Simulated time [s]."""
    time_limit: float
    """Horizon [s]."""
    unreachable: int
    """Robots for which no way to their goal was found."""
    failures: dict[str, str]
    """What became of the first ten robots without success, by name: ``timeout``, or ``collision with 'crate'``."""
    metrics: dict[str, float | None]
    """Metrics of the episode by key; None where undefined."""


class BenchmarkResult(Result):
    """What ``irsim benchmark`` found."""

    scenarios: list[str]
    """The files."""
    behaviors: list[str]
    """The behaviors; differences are to the first."""
    seeds: list[int]
    """The seeds, the same for all."""
    step_time: dict[str, float]
    """Period of each scenario [s]: metrics are sampled at every step."""
    random: dict[str, list[str]]
    """What the seed decides in each scenario; one where it decides nothing is run with the first seed only."""
    rows: list[BenchmarkRow]
    """By scenario, then behavior; then all scenarios together, if there are several with as many episodes each."""
    episodes: list[EpisodeRow]
    """Every episode."""
    notes: list[str]
    """What to know before reading on."""
    warnings: dict[str, list[Finding]]
    """What is odd about the scenarios."""
    version: str
    """Version of irsim."""
    reproduce: str
    """Command that gives the same again."""


class RenderResult(Result):
    """What ``irsim render`` drew."""

    scenario: str
    """The file."""
    seed: int
    """Seed that was used."""
    steps: int
    """Executed steps."""
    frames: int
    """Pictures drawn."""
    size: tuple[int, int]
    """Width and height [px]."""
    files: list[str]
    """Files written."""
    warnings: list[Finding]
    """What is odd about the scenario."""
    reproduce: str
    """Command that gives the same again."""


class ReplayResult(Result):
    """The page that ``irsim replay`` wrote."""

    run_id: str
    """The run it shows."""
    file: str
    """The page."""
    bytes: int
    """Its size."""
    objects: int
    """Robots and obstacles in it."""
    last_step: int
    """Last step in it."""
    every: int
    """Every how many-th step it shows; 1: all."""
    scans: Literal["none", "recorded", "computed"]
    """Whether scans are as recorded, or computed in the page from the shapes it draws."""
    notes: list[str] = Field(default_factory=list)
    """What the record lacks, because there was too much of it."""


class RunTable(Result):
    """What ``irsim inspect`` found in a recorded run."""

    run_id: str
    """Which run."""
    status: Literal["running", "finished", "cancelled", "interrupted"]
    """``interrupted``: cut short, nobody writes it any more; what there is, is shown."""
    outcome: Literal["success", "collision", "timeout"] | None
    """How it ended; None if it has no result."""
    summary: str
    """One sentence about it."""
    view: str
    """What the table shows."""
    columns: list[str]
    """Names of the columns; lengths in m, times in s, angles in rad."""
    rows: list[list[float | int | str | bool | None]]
    """The rows."""
    total: int
    """How many rows there are in all."""
    every: int
    """Every how many-th step is shown."""
    from_step: int
    """First step looked at."""
    to_step: int
    """Last step looked at."""
    next_cursor: str | None
    """Where the next page begins; None on the last one."""
    notes: list[str] = Field(default_factory=list)
    """What the record lacks, because there was too much of it, so that the table lacks it, too."""


class RobotPose(Result):
    """Where a robot is in a snapshot."""

    name: str
    label: str
    """What stands beside it in the picture; beside its goal that with ``G-`` before it."""
    pose: tuple[float, float, float]
    """x, y [m] and heading [rad]."""
    goal: tuple[float, float] | None
    """Present goal [m]; None without one."""
    status: Literal["under way", "arrived", "collided"]
    """What became of it so far."""


class MovingPose(Result):
    """Where a moving obstacle is in a snapshot."""

    name: str
    pose: tuple[float, float, float]
    """x, y [m] and heading [rad]."""
    velocity: tuple[float, float]
    """Along x and y of the world [m/s]; an omni drive need not move where it heads."""


class RobotPlan(Result):
    """The way that a robot would take over its goals."""

    name: str
    label: str
    """What stands beside it in the picture."""
    own: bool
    """Its own behavior has planned it; else it is a shortest way round what stands still, which it may not know."""
    length: float
    """Of the way, as far as there is one [m]."""
    margin: float | None
    """About the least distance between what stands still and a disc inside of the robot's body [m]; None where nothing
    stands."""
    tightest: tuple[float, float]
    """Where that is [m]."""
    lost: tuple[float, float] | None
    """A goal that it cannot get to [m]; None if it gets to all of them."""


class SnapshotResult(Result):
    """What ``irsim.api.snapshot`` drew."""

    scenario: str
    """The file, or ``(text)``."""
    seed: int
    """Seed that was used."""
    random: list[str]
    """What the seed decides; empty if every seed gives the same run."""
    steps: int
    """Executed steps."""
    sim_time: float
    """Simulated time [s]."""
    extent: tuple[float, float, float, float]
    """The world: least and greatest x, least and greatest y [m]."""
    obstacles: int
    """How many obstacles there are: those of entries."""
    contents: str
    """The obstacles in words: with the boundary and the map."""
    robots: list[RobotPose]
    """One entry per robot."""
    moving: list[MovingPose]
    """One entry per obstacle that can move."""
    moments: list[int] = []
    """Steps in the picture, from left to right and top to bottom, if it shows several."""
    plans: list[RobotPlan] = []
    """The ways of robots, if they were asked for."""
    size: tuple[int, int]
    """Width and height [px]."""
    warnings: list[Finding]
    """What is odd about the scenario."""
    reproduce: str
    """Command that draws the same moment."""
    png: bytes = Field(default=b"", exclude=True, repr=False)
    """The picture."""
