"""The typed results of a run: of ``irsim.run``, and of ``irsim inspect`` and ``irsim replay`` from its record."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from irsim.common.event_kinds import EventKind
from irsim.results.base import Result
from irsim.results.findings import Finding

__all__ = ["EventRecord", "HorizonSource", "Left", "ReplayResult", "RobotResult", "RunResult", "RunTable", "ZoneResult"]

HorizonSource = Literal["argument", "scenario", "default", "limits"]
"""Where the time limit of a run comes from."""


class EventRecord(Result):
    """Something that happened in an episode."""

    kind: EventKind
    """``collision`` is reported when contact begins, ``no_path`` when ``follow`` finds no path, or none round
    ``partner``, which stands for good, ``overshoot`` when an object passes its goal within ``goal_threshold``
    between two steps without arriving, ``zone_entry`` and ``zone_exit`` when a body begins and ceases to touch a
    region of ``world.zones``, ``line_crossing`` when a centre crosses a line, ``sight_start`` and ``sight_end`` when
    another object comes into and goes out of a field of view, ``contact_between_steps`` when two objects touch
    within a step and are apart at its beginning and at its end, and ``passed_through`` if the middle of one of them
    went through the other then."""
    time: float
    """Simulated time [s]; of a contact between steps, and of a collision with ``world.contacts: swept``, when the two
    first touch within the step."""
    step: int
    """Steps executed; 0 is the initial state."""
    object: str
    """Name of the object; in a contact, of the first of the two; of a sight, of the one that sees."""
    partner: str | None
    """Name of the other object in a contact, or of the object that is seen."""
    x: float
    """Position of the object, or of the one that is seen; for a line, where it is crossed [m]."""
    y: float
    """Position of the object, or of the one that is seen; for a line, where it is crossed [m]."""
    zone: str | None = None
    """Name of the zone."""
    direction: Literal["left_to_right", "right_to_left"] | None = None
    """How a line is crossed, as seen from its first point towards its second."""
    depth: float | None = None
    """Deepest overlap within the step, of a contact between steps [m]."""


class Left(Result):
    """An object that left the world."""

    name: str
    time: float
    """Time when it left [s]."""
    x: float
    y: float


class RobotResult(Result):
    """How the episode ended for one robot."""

    name: str
    outcome: Literal["success", "collision", "timeout"]
    """``success``: arrived without a collision before; ``collision``: stopped by one, or arrived after one;
    ``timeout``: neither."""
    time_to_goal: float | None
    """Time of first arrival [s]; None when it never arrived."""
    collision_count: int
    """Number of contacts that began."""
    contacts_between_steps: int = 0
    """Number of contacts that began and ended within one step; they decide ``outcome`` only with ``world.contacts:
    swept``."""
    passed_through: list[str] = Field(default_factory=list)
    """The first ten objects that it passed through between two steps, or that passed through it."""
    infeasible_steps: int | None = None
    """Steps in which its behavior found no velocity that avoids all others (only ``orca`` and ``avocado`` report this);
    None if there were none."""
    path_length: float
    """Distance travelled until the end of the run [m]."""
    distance_to_goal: float | None
    """Distance to the present goal at the end [m]; None without a goal."""
    min_clearance: float | None = None
    """Smallest distance, edge to edge, to anything it could hit, at the end of any step until it arrived [m]; negative:
    overlap; None if there is nothing to hit, and in runs of more than two million poses."""
    nearest: str | None = None
    """Name of that nearest object."""
    nearest_called: str | None = None
    """That object in a sentence: its name in quotes, `the map` or `the walls round the world`."""
    nearest_at: tuple[float, float] | None = None
    """Where the robot was then, x and y [m]."""
    heading_error: float | None = None
    """Difference between its heading at the end and that of its goal [rad]; None where the heading does not count."""
    time_in_zone: float | None = None
    """Time in which its body touched a region of ``world.zones``, until it arrived [s]; None without regions."""
    zone_crossings: int | None = None
    """Entries into regions after the start, plus crossings of lines (+1 from left to right, -1 from right to left),
    until it arrived; None without ``world.zones``."""
    seen_ratio: float | None = None
    """Share of time, until it arrived, in the field of view (``fov``) of another object; None if none has one."""
    goal_visible_ratio: float | None = None
    """Share of time, until it arrived, with a straight line to its goal free of static objects; None without a goal,
    and in runs of more than two million poses."""
    pose: tuple[float, float, float]
    """x, y [m] and heading [rad] at the end."""


class ZoneResult(Result):
    """What robots and moving obstacles did in a zone of ``world.zones``, in the whole run."""

    objects: int
    """Number of objects that were in the region, or crossed the line."""
    names: list[str]
    """The first ten of them, in order of time."""
    robots: list[str] = []
    """The first ten robots among them, in order of time."""
    first_time: float | None
    """When the first of them was there [s]; None if there was none."""
    entries: int | None = None
    """Entries after the start; None for a line."""
    time_in_zone: float | None = None
    """Time in the region, of all objects together [s]; None for a line."""
    left_to_right: int | None = None
    """Crossings from left to right, as seen from the first point of the line; None for a region."""
    right_to_left: int | None = None
    """Crossings from right to left; None for a region."""


class RunResult(Result):
    """What ``irsim run`` did."""

    scenario: str
    """The file."""
    seed: int
    """Seed that was used."""
    random: list[str]
    """What the seed decides; empty if every seed gives the same run."""
    behavior: str | None = None
    """Behavior of every robot instead of its own; None: the scenario as written."""
    policy: str | None = None
    """Policy in Python that drove every robot; None: behaviors did."""
    policy_digest: str | None = None
    """SHA-256 of the file of this policy; None without one."""
    perturb: list[str] = Field(default_factory=list)
    """Perturbations of starts, speeds and delays, as on the command line."""
    outcome: Literal["success", "collision", "timeout"]
    """``success`` when every robot succeeded, ``collision`` when any collided, otherwise ``timeout``, also if the run
    ended early because something was ``lost``."""
    summary: str
    """One sentence: which robots arrived, which did not, and why. It begins with the first contact between steps of a
    robot, if there was one that did not count as a collision."""
    reason: str | None = None
    """Why the run failed: contacts between steps, the first collision, and what robots that did not arrive were doing;
    None on success."""
    lost: str | None = None
    """Why the policy, or the program at the other end of a bridge, could not go on, which ended the run early; None
    otherwise. Only policies in other processes are lost."""
    lost_code: Literal["bridge-lost", "policy-lost"] | None = None
    """Which of the two was lost; None if neither was."""
    decisive_step: int | None = None
    """Step that decided the outcome: of the first collision of a robot, or in which one without success passed through
    something between two steps, or in which the first robot that did not arrive ceased to make progress; None on
    success, and if such robots moved on until the end."""
    steps: int
    """Number of executed steps."""
    sim_time: float
    """Simulated time [s]."""
    time_limit: float
    """Time limit [s]: from the file, from ``--steps``, or max(30 s, 4 x longest path / top speed)."""
    time_limit_from: HorizonSource
    """Where the time limit comes from; ``limits``: cut to the maximum number of steps of one run."""
    robots: list[RobotResult]
    """One entry per robot."""
    parked: list[str] = Field(default_factory=list)
    """Robots that cannot move and have no goal of their own; they never arrive."""
    jammed: list[str] = Field(default_factory=list)
    """Moving obstacles that a collision with another obstacle has stopped."""
    left: list[Left] = Field(default_factory=list)
    """The first moving objects whose position left the world; ``world.boundary: walls`` keeps objects in."""
    jumped: list[str] = Field(default_factory=list)
    """The first objects that passed a goal within ``goal_threshold`` between two steps and did not arrive later."""
    explored: float | None = None
    """Share of the area of the world, insides of obstacles included, that the robots have seen, from 0 to 1; None
    without `fog_map`."""
    human_contacts: int = 0
    """Number of contacts that began between two people: moving obstacles, or objects tagged ``pedestrian``."""
    contacts_between_steps: int = 0
    """Number of contacts of any two objects that began and ended within one step; ``events`` has the first ones."""
    zones: dict[str, ZoneResult] = Field(default_factory=dict)
    """What happened in each zone of ``world.zones``, by its name."""
    events: list[EventRecord]
    """The first events, in order; repeated arrivals of an object at the same goal count once. If there are too many,
    ``sight_start`` and ``sight_end`` are left out first, and contacts between steps last."""
    event_count: int
    """Number of such events."""
    warnings: list[Finding]
    """Warnings about the scenario."""
    files: list[str] = Field(default_factory=list)
    """Files written."""
    version: str
    """Version of irsim."""
    reproduce: str
    """Command that reproduces this result."""
    run_id: str | None = None
    """Id of the recorded run, for ``irsim inspect``; None if it was not recorded."""
    artifacts: dict[str, str] = Field(default_factory=dict)
    """Files of the record by name."""
    notes: list[str] = Field(default_factory=list)
    """What the record leaves out because there was too much of it, and what bridges tell."""


class RunTable(Result):
    """What ``irsim inspect`` found in a recorded run."""

    run_id: str
    """Id of the run."""
    status: Literal["running", "finished", "cancelled", "interrupted"]
    """``interrupted``: cut short, no process writes it any more; the table shows what was recorded."""
    outcome: Literal["success", "collision", "timeout"] | None
    """How it ended; None if it has no result."""
    lost: str | None = None
    """Why the policy or the program of a bridge could not go on, which ended it early; None otherwise."""
    summary: str
    """One sentence about the run."""
    view: str
    """What the table shows."""
    columns: list[str]
    """Names of the columns; lengths in m, times in s, angles in rad."""
    rows: list[list[float | int | str | bool | None]]
    """The rows."""
    total: int
    """Number of rows on all pages together."""
    every: int
    """Every Nth step is shown."""
    from_step: int
    """First step of the table."""
    to_step: int
    """Last step of the table."""
    next_cursor: str | None
    """Cursor of the next page; None on the last one."""
    notes: list[str] = Field(default_factory=list)
    """What the record, and so the table, leaves out because there was too much of it."""


class ReplayResult(Result):
    """The page that ``irsim replay`` wrote."""

    run_id: str
    """Id of the run it shows."""
    file: str
    """The page."""
    bytes: int
    """Size of the page [bytes]."""
    objects: int
    """Number of robots and obstacles in it."""
    last_step: int
    """Last step in it."""
    every: int
    """It shows every Nth step; 1: all."""
    scans: Literal["none", "recorded", "computed"]
    """Whether scans are taken from the record, or computed in the page from the shapes it draws."""
    notes: list[str] = Field(default_factory=list)
    """What the record leaves out because there was too much of it."""
