"""The typed results of a run: of ``irsim.run``, and of ``irsim inspect`` and ``irsim replay`` from its record."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

from pydantic import Field, PrivateAttr

from irsim.common.event_kinds import BETWEEN_STEPS, SIGHTS
from irsim.common.lazy import call_home
from irsim.common.notebook import Page, facts, section, table, text_table
from irsim.common.text import clean
from irsim.results.base import Result
from irsim.results.concise import ConciseEvent, ConciseRobot, ConciseRun, is_command, rounded
from irsim.results.episode import EventRecord, Left, RobotResult, ZoneResult
from irsim.results.findings import Finding

__all__ = [
    "LOST_THINGS",
    "MAX_CONCISE",
    "MAX_DETAILED",
    "Again",
    "EpisodeUntil",
    "HorizonSource",
    "ReplayResult",
    "RunResult",
    "RunTable",
    "RunsResult",
    "Until",
]

HorizonSource = Literal["argument", "scenario", "default", "limits"]
"""Where the time limit of a run comes from."""
EpisodeUntil = Literal["done", "first_collision"]
"""When an episode of a benchmark ends: when every robot has arrived or stopped, also when a robot collides."""
Until = Literal[EpisodeUntil, "time_limit"]
"""When a run ends: as IR-SIM ends it, when every robot has arrived or stopped, or at its time limit, too."""
MAX_CONCISE = 10
"""Number of robots and events in a concise result."""
MAX_DETAILED = 50
"""Number of robots and events in a detailed result."""
LOST_THINGS = {"bridge-lost": "program of a bridge", "policy-lost": "policy"}
"""The thing that was lost, by ``lost_code``."""


class Again:
    """How a run is simulated again for its table and its replay; all are equal, because results differ by contents.

    Attributes:
        arguments: Arguments of ``irsim.run``; None if they are not known, as in another process.
        folder: Folder of the recording of the second run, if there is one.
    """

    arguments: dict[str, Any] | None = None
    folder: str = ""

    def __eq__(self, other: object) -> bool:
        return other is None or isinstance(other, Again)

    __hash__ = None  # type: ignore[assignment]

    def __deepcopy__(self, memo: object) -> Again:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return Again, ()


class RunResult(Result):
    """The result of ``irsim run``."""

    scenario: str
    """The file."""
    seed: int
    """Seed that was used."""
    random: list[str]
    """Parts that the seed decides; empty if every seed gives the same run."""
    behavior: str | None = None
    """Behavior of every robot instead of its own; None: the scenario as written."""
    policy: str | None = None
    """Policy in Python that drove every robot; None: behaviors did."""
    policy_digest: str | None = None
    """SHA-256 of the file of this policy; None without one."""
    perturb: list[str] = Field(default_factory=list)
    """Perturbations of starts, speeds and delays, as on the command line."""
    until: Until = "done"
    """``done``: the run ends when every robot has arrived or stopped, one with ``loop`` at the end of its first lap;
    ``time_limit``: it goes on to its time limit; ``first_collision``: it also ends when a robot collides."""
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
    """Results of each zone of ``world.zones``, by its name."""
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
    """Parts that the record leaves out because there was too much of them, and messages of bridges."""
    _again: Again | None = PrivateAttr(None)

    def to_pandas(
        self,
        rows: Literal["steps", "robots"] = "steps",
        *,
        objects: str | Sequence[str] = "movers",
        ranges: bool = False,
    ) -> Any:
        """A table of pandas; of steps with the columns that ``irsim export`` writes as Parquet.

        For a table of steps, a run without a recording (``record=True`` makes one) is simulated again.
        ``attrs["units"]`` of that table has the unit of each column.

        Args:
            rows: ``steps``: one row per step and object; ``robots``: one row per robot, with the facts of ``robots``.
            objects: Which objects the rows of steps have: ``movers`` (robots, and obstacles that can move), ``robots``,
                ``people``, ``all``, or names.
            ranges: Whether the rows of steps have the ranges of lidars.

        Raises:
            ExtraError: pandas is missing.
            InputError: There is no such kind of rows, or the run has no recording and cannot be simulated again.
            RunError: There is no such object, or the recording was deleted.
        """
        return call_home("irsim.api.kept_run:runs_table", [self], rows, objects, ranges)

    def replay(self, height: int = 640) -> Page:
        """The replay of the run: a page that a notebook shows below the cell; ``.save("replay.html")`` writes it.

        A run without a recording is simulated again for it.

        Args:
            height: Height in the notebook [px].

        Raises:
            InputError: The run has no recording and cannot be simulated again.
            RunError: The recording was deleted.
        """
        page: Page = call_home("irsim.api.kept_run:run_replay", self, height)
        return page

    def __repr__(self) -> str:
        return f"{self.scenario}: {self.summary}\n{text_table(*self._table())}\nreproduce: {clean(self.reproduce, 400)}"

    __str__ = __repr__

    def _repr_html_(self) -> str:
        known = {"seed": self.seed, "simulated": f"{self.sim_time:g} s in {self.steps} steps"}
        known |= {"reproduce": self.reproduce}
        return section(f"{self.scenario}: {self.summary}", table(*self._table()) if self.robots else "", facts(known))

    def _table(self) -> tuple[Sequence[str], list[Sequence[object]]]:
        """The columns and rows that show the result."""
        columns = ("robot", "outcome", "time to goal [s]", "collisions", "path [m]", "smallest clearance [m]")
        keys = ("name", "outcome", "time_to_goal", "collision_count", "path_length", "min_clearance")
        return columns, [[getattr(one, key) for key in keys] for one in self.robots]

    def concise(
        self, *, detailed: bool = False, artifacts: dict[str, str] | None = None, advice: str = ""
    ) -> ConciseRun:
        """A short form of the result; its ``text()`` puts it into words.

        Args:
            detailed: Keep more robots and events, and the path and pose of each robot.
            artifacts: Addresses of files of the recorded run; None without any.
            advice: The next call to make.
        """
        most = MAX_DETAILED if detailed else MAX_CONCISE
        robots = sorted(self.robots, key=lambda robot: robot.outcome == "success")
        return ConciseRun(
            run_id=self.run_id,
            outcome=self.outcome,
            reason=None if self.reason is None else clean(self.reason, 500),
            summary=clean(self.summary, 300),
            seed=self.seed,
            random=self.random,
            behavior=clean(self.behavior or self.policy or "", 200) or None,
            incidents=self._incidents() or None,
            steps=self.steps,
            sim_time=rounded(self.sim_time),
            time_limit=rounded(self.time_limit),
            time_limit_from=self.time_limit_from,
            robots=[ConciseRobot.of(robot, detailed=detailed) for robot in robots[:most]],
            robot_count=len(robots),
            events=[ConciseEvent.of(event) for event in (self.events[:most] if detailed else self._chosen_events())],
            event_count=self.event_count,
            warnings=[clean(line, 300) for line in self._warning_lines()],
            artifacts=artifacts,
            reproduce=clean(self.reproduce, 300) if is_command(self.reproduce) else None,
            next=advice,
        )

    def _incidents(self) -> dict[str, Any]:
        """Incidents besides outcomes: contacts between steps or people, objects that left the world or jumped goals."""
        incidents: dict[str, Any] = {
            "contacts_between_steps": self.contacts_between_steps,
            "human_contacts": self.human_contacts,
            "left": [clean(item.name) for item in self.left],
            "jumped": [clean(name) for name in self.jumped],
        }
        return {key: value for key, value in incidents.items() if value}

    def _chosen_events(self) -> list[EventRecord]:
        """A few events in order; contacts between steps are kept first, then events of robots, waypoints last."""
        robots = {robot.name for robot in self.robots}

        def rank(event: EventRecord) -> tuple[bool, bool, bool]:
            of_robot = bool(robots & {event.object, event.partner})
            return event.kind not in BETWEEN_STEPS, event.kind in SIGHTS, not of_robot

        kept = sorted((event for event in self.events if event.kind != "waypoint"), key=rank)[:MAX_CONCISE]
        kept += [event for event in self.events if event.kind == "waypoint"][: MAX_CONCISE - len(kept)]
        return sorted(kept, key=lambda event: event.step)  # a stable sort keeps the order within a step

    def _warning_lines(self) -> list[str]:
        """The first warnings about the scenario, and the notes on the recording."""
        warnings = [item for item in self.warnings if item.severity == "warning"]
        lines = [
            f"{item.code} at {item.path}: {item.message}{' (also in base)' * bool(item.in_base)}"
            for item in warnings[:MAX_CONCISE]
        ]
        if len(warnings) > MAX_CONCISE:
            lines.append(f"{len(warnings) - MAX_CONCISE} more: validate_scenario lists them")
        return [*lines, *(f"the recording is incomplete: {note}" for note in self.notes)]


class RunsResult(Result):
    """The result of ``irsim run --seeds``: an episode for each seed."""

    scenario: str
    """The file."""
    summary: str
    """How many episodes succeeded, and which seeds failed."""
    failed: dict[str, list[int]]
    """Seeds of the episodes that did not succeed, by outcome."""
    crowded: list[int]
    """Seeds that leave no room for an object; they have no episode."""
    not_run: list[int]
    """Seeds for which there was no time."""
    same: bool
    """Whether nothing is random, so that one episode stands for all seeds, and others were not run or are equal."""
    episodes: list[RunResult]
    """The episodes, in the order of the seeds."""
    warnings: list[Finding]
    """Findings of the scenario check, hints included."""
    version: str
    """Version of irsim."""

    def to_pandas(
        self,
        rows: Literal["steps", "robots"] = "steps",
        *,
        objects: str | Sequence[str] = "movers",
        ranges: bool = False,
    ) -> Any:
        """All episodes as one table of pandas.

        Args:
            rows: ``steps``: one row per step and object, as of each episode; ``robots``: one row per episode and robot,
                with the facts of ``episodes[…].robots``.
            objects: Which objects the rows of steps have: ``movers``, ``robots``, ``people``, ``all``, or names.
            ranges: Whether the rows of steps have the ranges of lidars.

        Raises:
            ExtraError: pandas is missing.
            InputError: There is no such kind of rows, or a run cannot be simulated again.
        """
        return call_home("irsim.api.kept_run:runs_table", self.episodes, rows, objects, ranges)

    def __repr__(self) -> str:
        return f"{len(self.episodes)} episodes of {self.scenario}: {self.summary}\n{text_table(*self._table())}"

    __str__ = __repr__

    def _repr_html_(self) -> str:
        return section(f"{self.scenario}: {self.summary}", table(*self._table()))

    def _table(self) -> tuple[Sequence[str], list[Sequence[object]]]:
        """The columns and rows that show the result."""
        rows: list[Sequence[object]] = [(one.seed, one.outcome, one.sim_time, one.reason) for one in self.episodes]
        return ("seed", "outcome", "simulated [s]", "reason"), rows

    @property
    def shown(self) -> RunResult:
        """The first episode that failed, else the first one."""
        return next((one for one in self.episodes if one.outcome != "success"), self.episodes[0])


class RunTable(Result):
    """A table of ``irsim inspect`` about a recorded run."""

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
    """The view that the table shows."""
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
    """Parts that the record, and so the table, leaves out because there was too much of them."""

    def records(self) -> list[dict[str, Any]]:
        """The rows by the names of their columns."""
        return [dict(zip(self.columns, row, strict=True)) for row in self.rows]


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
    """Parts that the record leaves out because there was too much of them."""
