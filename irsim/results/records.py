"""Typed results of comparing, exporting and replaying records, and of importing maps."""

from __future__ import annotations

from typing import Any, Literal

from irsim.results.base import Result
from irsim.results.episode import EventRecord

__all__ = ["ExportResult", "MapImportResult", "MapLevel", "MapTrip", "Parting", "RunsDiff", "SetupChange"]


class ExportResult(Result):
    """The file that ``irsim export`` wrote."""

    run_ids: list[str]
    """Ids of the runs in it."""
    format: str
    """Its format."""
    file: str
    """The file, or the folder of a dataset."""
    bytes: int
    """Its size [bytes]."""
    objects: list[str]
    """Names of the objects in it."""
    steps: int
    """Number of steps in it, of all runs together."""
    notes: list[str]
    """Parts that the records or the file leave out."""


class SetupChange(Result):
    """Something that was different before the two runs began."""

    key: Literal["scenario", "seed", "irsim", "options", "horizon", "step_time", "objects"]
    """``scenario``: the text of the scenario; ``irsim``: the version; ``objects``: names that only one run has."""
    before: Any = None
    """Value of the first run; None for the text of a scenario."""
    after: Any = None
    """Value of the second run."""


class Parting(Result):
    """A quantity that differs in the first step in which two runs differ."""

    object: str
    """Name of the object."""
    quantity: str
    """``x``, ``y``, ``heading``, ``control_0``, …, ``goal_x``, ``goal_y``, ``goal_heading``, ``arrived``, ``collided``,
    ``stopped``, or ``ranges_0[17]``: of its first lidar, beam 17 is the first one that differs."""
    before: float | bool | None
    """Value in the first run; None where there is no number: no goal, or nothing hit."""
    after: float | bool | None
    """Value in the second run."""
    difference: float | None
    """``after - before``, of headings the smaller way around; None without two numbers."""
    beams: int | None = None
    """Number of beams of the lidar that differ; None for other quantities."""


class RunsDiff(Result):
    """The result of ``irsim diff-runs``."""

    before: str
    """Id of the first run."""
    after: str
    """Id of the second run."""
    same: bool
    """True if the states, scans, events and outcomes are equal; what is in ``setup`` may differ."""
    summary: str
    """One sentence: whether the runs are equal, or where they part."""
    setup: list[SetupChange]
    """Differences from before the runs began, such as the seed."""
    step: int | None
    """First step in which they differ; None if no step that both recorded does."""
    time: float | None
    """Simulated time of that step [s]."""
    parted: list[Parting]
    """Differences in that step, object by object; of many differences the first 50."""
    parted_count: int
    """Number of quantities that differ in that step."""
    last_steps: tuple[int, int]
    """Last recorded step of each run."""
    outcomes: tuple[str | None, str | None]
    """How each run ended; None without a result."""
    events_before: list[EventRecord]
    """Events that only the first run has, at most 20."""
    events_after: list[EventRecord]
    """Events that only the second run has, at most 20."""
    event_counts: tuple[int, int]
    """Number of events that only the first run has, and that only the second has."""
    notes: list[str]
    """Parts that the records leave out."""


class MapLevel(Result):
    """A level of a scene."""

    level: int
    """Its number, the lowest is 0."""
    height: float
    """Height of its floor along the upward axis [m]."""
    area: float
    """Area of its largest connected part [m²]."""
    roof: bool
    """Whether it lies above another level and under the sky: a roof, or the top floor of a file without ceilings."""


class MapTrip(Result):
    """A start and a goal on the map."""

    start: tuple[float, float, float]
    """x, y [m], heading [rad]."""
    goal: tuple[float, float, float]
    """x, y [m], heading [rad]."""
    clearance: float
    """Distance from everything that is not free, which a way between them keeps [m]."""


class MapImportResult(Result):
    """The map that ``irsim map import`` made."""

    kind: str
    """Kind of the file."""
    files: list[str]
    """Files written; empty if only levels were listed."""
    columns: int
    """Cells along x."""
    rows: int
    """Cells along y."""
    resolution: float
    """Side of a cell [m]."""
    origin: tuple[float, float]
    """Lower left corner [m]."""
    free_area: float
    """Area that is known to be free [m²]; unknown cells are not part of it."""
    occupied: int
    """Cells that are occupied in the scenario."""
    obstacles: int
    """Obstacles of the scenario, if it has them instead of a picture."""
    unknown: int
    """Cells of which nothing is known."""
    unknown_as: str
    """Their meaning in the scenario: free, occupied or unknown."""
    level: int
    """Level of the map."""
    height: float
    """Height of its floor along the upward axis of the file [m]."""
    levels: list[MapLevel]
    """All levels of the file, from the lowest; empty if it has none of its own."""
    components: list[float]
    """Areas of the connected parts of the level [m²], the largest first; at most 20."""
    kept: int | None
    """Number of the part that is free in the map; None if all are."""
    trip: MapTrip | None
    """A start and a goal for a robot; None if there is no room."""
    notes: list[str]
    """Remarks on the file and what was made of it."""
