"""The typed results of a run: of ``irsim.run``, and of ``irsim inspect`` and ``irsim replay`` from its record."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from irsim.results.base import Result
from irsim.results.findings import Finding

__all__ = ["EventRecord", "HorizonSource", "Left", "ReplayResult", "RobotResult", "RunResult", "RunTable"]

HorizonSource = Literal["argument", "scenario", "default", "limits"]
"""Who says how long a run may last."""


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


class Left(Result):
    """An object that left the world."""

    name: str
    time: float
    """When [s]."""
    x: float
    y: float


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
