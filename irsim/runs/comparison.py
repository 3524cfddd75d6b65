"""``irsim.diff_runs``: whether two recorded runs are equal, and the first step and quantities in which they differ."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from irsim.common.angles import wrap
from irsim.common.arguments import as_given
from irsim.common.keywords import answers_misspelt
from irsim.common.text import clean
from irsim.results.episode import EventRecord
from irsim.results.records import Parting, RunsDiff, SetupChange
from irsim.runs.files import RunError
from irsim.runs.reading import Run, open_run
from irsim.runs.store import SCENARIO_FILE
from irsim.simulation.events import Event
from irsim.simulation.trace import Trace

__all__ = ["diff_runs"]

_BLOCK_NUMBERS = 2_000_000
"""Number of values of one block of each run, which bounds the memory of a comparison."""
_MAX_PARTINGS = 50
_MAX_EVENTS = 20
_ANGLES = ("heading", "goal_heading")
_AXES = {
    "pose": ("x", "y", "heading"),
    "control": ("control_0", "control_1", "control_2"),
    "goal": ("goal_x", "goal_y", "goal_heading"),
}
_SETUP: tuple[Literal["seed", "irsim", "options", "horizon", "step_time"], ...] = (
    "seed",
    "irsim",
    "options",
    "horizon",
    "step_time",
)
_FLAGS = ("arrived", "collided", "stopped")


@dataclass(frozen=True)
class _Pair:
    """A quantity of all compared objects in both runs.

    Attributes:
        names: Name of the quantity in each of the C columns.
        objects: Name of the object of each column.
        before, after: (T, C) values.
        is_scan: Whether the columns are the beams of one lidar.
    """

    names: list[str]
    objects: list[str]
    before: NDArray[Any]
    after: NDArray[Any]
    is_scan: bool = False

    def differs(self, tolerance: float) -> NDArray[np.bool_]:
        """(T, C) whether two values differ by more than the tolerance; NaN equals NaN."""
        if self.before.dtype == np.bool_:
            return np.asarray(self.before != self.after)
        same = (self.before == self.after) | (np.isnan(self.before) & np.isnan(self.after))
        if tolerance:
            with np.errstate(invalid="ignore"):
                same |= np.abs(self.distance()) <= tolerance
        return np.asarray(~same)

    def distance(self) -> NDArray[np.float64]:
        """(T, C) second value minus first; of angles the smaller way around."""
        with np.errstate(invalid="ignore"):
            away = self.after.astype(np.float64) - self.before.astype(np.float64)
            angles = np.array([name in _ANGLES for name in self.names], dtype=bool)
            away[:, angles] = wrap(away[:, angles])
        return away


@answers_misspelt
def diff_runs(
    before: str | Path | Run, after: str | Path | Run, *, tolerance: float = 0.0, workspace: str | Path | None = None
) -> RunsDiff:
    """Compare two recorded runs step by step: states, controls, goals, flags, scans and events.

    Objects are matched by name. Runs are read piece by piece, up to the first difference.

    Args:
        before: Id of a run, its folder, or ``last``.
        after: The other run.
        tolerance: Numbers that differ by at most this much (in m, rad, m/s, rad/s) count as equal. Events are equal if
            they have the same kind, step and objects.
        workspace: Folder whose ``.irsim/runs`` holds the runs; default: the current directory.

    Raises:
        RunError: There is no such run, it cannot be read, or the tolerance is negative.
    """
    given: Any = tolerance
    if not (isinstance(given, (int, float)) and 0 <= given < math.inf):
        what = f"tolerance must be a number from 0 on, got {as_given(given)}"
        raise RunError("bad-argument", what, "give 0 for equality bit by bit, or such as 1e-9", where="tolerance")
    runs = tuple(run if isinstance(run, Run) else open_run(run, workspace) for run in (before, after))
    first, second = runs
    setup = _setup(first, second)
    step, parted, count = _first_difference(first, second, tolerance)
    events = _only_in(first.events, second.events), _only_in(second.events, first.events)
    ends = first.last_step, second.last_step
    outcomes = tuple(None if run.result is None else run.result.outcome for run in runs)
    same = (
        step is None
        and ends[0] == ends[1]
        and not any(events)
        and outcomes[0] == outcomes[1]
        and not any(change.key in ("objects", "step_time") for change in setup)
    )
    difference = RunsDiff(
        before=first.id,
        after=second.id,
        same=same,
        summary="",
        setup=setup,
        step=step,
        time=None if step is None else step * first.step_time,
        parted=parted,
        parted_count=count,
        last_steps=ends,
        outcomes=(outcomes[0], outcomes[1]),
        events_before=[EventRecord(**event._asdict()) for event in events[0][:_MAX_EVENTS]],
        events_after=[EventRecord(**event._asdict()) for event in events[1][:_MAX_EVENTS]],
        event_counts=(len(events[0]), len(events[1])),
        notes=[f"{run.id}: {note}" for run in runs for note in run.notes],
    )
    difference.summary = _summary(difference)
    return difference


def _setup(first: Run, second: Run) -> list[SetupChange]:
    """Differences from before the runs began."""
    changes = []
    if first.scenario_text != second.scenario_text:
        files = [str(run.folder / SCENARIO_FILE) for run in (first, second)]
        changes.append(SetupChange(key="scenario", before=files[0], after=files[1]))
    for key in _SETUP:
        before, after = first.meta.get(key), second.meta.get(key)
        if before != after:
            changes.append(SetupChange(key=key, before=before, after=after))
    lone = [
        [name for name in run.names if name not in other.names] for run, other in ((first, second), (second, first))
    ]
    if any(lone):
        changes.append(SetupChange(key="objects", before=lone[0], after=lone[1]))
    return changes


def _first_difference(first: Run, second: Run, tolerance: float) -> tuple[int | None, list[Parting], int]:
    """First step in which common objects differ, what differs in it (of many the first ones), and how much does."""
    common = [name for name in first.names if name in set(second.names)]
    columns = [[run.names.index(name) for name in common] for run in (first, second)]
    beams = max(sum(int(count) for _, count in run.meta["sensors"]) for run in (first, second))
    rows = max(1, _BLOCK_NUMBERS // max(1, 12 * len(common) + beams))
    for before, after in zip(first.blocks(rows, columns[0]), second.blocks(rows, columns[1]), strict=False):
        length = min(len(before), len(after))
        if int(before.step[0]) != int(after.step[0]):
            return int(min(before.step[0], after.step[0])), [], 0
        pairs = list(_pairs(before, after, length))
        differing = [pair.differs(tolerance) for pair in pairs]
        begun = [int(np.argmax(where.any(axis=1))) for where in differing if where.any()]
        if begun:
            row = min(begun)
            partings = [
                one
                for pair, where in zip(pairs, differing, strict=True)
                if row < len(where)
                for one in _partings(pair, row, np.flatnonzero(where[row]))
            ]
            partings.sort(key=lambda one: common.index(one.object))
            return int(before.step[row]), partings[:_MAX_PARTINGS], len(partings)
    return None, [], 0


def _pairs(before: Trace, after: Trace, length: int) -> Iterator[_Pair]:
    """The quantities of both runs over some rows; scans only as far as both recorded them."""
    names = list(before.names)
    for field, axes in _AXES.items():
        values = [getattr(trace, field)[:length].reshape(length, -1) for trace in (before, after)]
        yield _Pair(list(axes) * len(names), [name for name in names for _ in axes], *values)
    for flag in _FLAGS:
        yield _Pair([flag] * len(names), names, getattr(before, flag)[:length], getattr(after, flag)[:length])
    for key in sorted(before.ranges.keys() & after.ranges.keys()):
        scans = before.ranges[key], after.ranges[key]
        known = min(length, *map(len, scans))
        name, _, number = key.rpartition("/")
        beams = min(scan.shape[1] for scan in scans)
        quantities = [f"ranges_{number}[{beam}]" for beam in range(beams)]
        first, second = (scan[:known, :beams] for scan in scans)
        yield _Pair(quantities, [name] * beams, first, second, is_scan=True)
    for key in sorted(before.readings.keys() & after.readings.keys()):
        tables = [_numbers(trace.readings[key][:length]) for trace in (before, after)]
        name, _, sensor = key.rpartition("/")
        columns = [f"{sensor}.{column}" for column in before.readings[key].dtype.names or ()]
        known, width = min(map(len, tables)), min(table.shape[1] for table in tables)
        quantities = (columns * (width // max(1, len(columns)) + 1))[:width]
        one, two = (table[:known, :width] for table in tables)
        yield _Pair(quantities, [name] * width, one, two)


def _numbers(rows: NDArray[np.void]) -> NDArray[np.float64]:
    """(T, n) numbers of the readings of one sensor."""
    return np.ascontiguousarray(rows).view(np.float64).reshape(len(rows), -1)


def _partings(pair: _Pair, row: int, columns: NDArray[np.int64]) -> list[Parting]:
    """Differences in a row; of a scan the first beam that does."""
    if pair.is_scan:
        return [_parting(pair, row, int(columns[0]), len(columns))] if len(columns) else []
    return [_parting(pair, row, column) for column in columns.tolist()]


def _parting(pair: _Pair, row: int, column: int, beams: int | None = None) -> Parting:
    flag = pair.before.dtype == np.bool_
    values = [bool(v) if flag else _number(v) for v in (pair.before[row, column], pair.after[row, column])]
    return Parting(
        object=pair.objects[column],
        quantity=pair.names[column],
        before=values[0],
        after=values[1],
        difference=None if flag or None in values else _number(pair.distance()[row, column]),
        beams=beams,
    )


def _number(value: Any) -> float | None:
    """A number as JSON has it; None if it is not finite."""
    return float(value) if math.isfinite(value) else None


def _only_in(events: list[Event], others: list[Event]) -> list[Event]:
    """Events that the other run does not have, in order; positions do not count."""
    left = Counter(map(_identity, others))
    lone = []
    for event in events:
        left[_identity(event)] -= 1
        if left[_identity(event)] < 0:
            lone.append(event)
    return lone


def _identity(event: Event) -> tuple[str, int, str, str | None, str | None, str | None]:
    return event.kind, event.step, event.object, event.partner, event.zone, event.direction


def _summary(difference: RunsDiff) -> str:
    """One sentence: whether the runs are equal, or where they part."""
    keys = [change.key for change in difference.setup]
    although = f", although {' and '.join(keys)} differ" if keys else ""
    if difference.same:
        return f"the runs are equal in all {difference.last_steps[0]} steps{although}"
    if difference.step is not None:
        where = f"the runs part at step {difference.step} ({difference.time:g} s)"
        if not difference.parted:
            return f"{where}: they begin with different steps"
        one = difference.parted[0]
        more = f", and {difference.parted_count - 1} more" if difference.parted_count > 1 else ""
        values = f"{_shown(one.before)} and {_shown(one.after)}"
        return f"{where}: {one.quantity} of '{clean(one.object, 40)}' is {values}{more}"
    reasons = []
    if difference.last_steps[0] != difference.last_steps[1]:
        reasons.append(
            f"{difference.before} ends with step {difference.last_steps[0]}, "
            f"{difference.after} with {difference.last_steps[1]}"
        )
    if any(difference.event_counts):
        reasons.append(f"{sum(difference.event_counts)} events are only in one of them")
    if difference.outcomes[0] != difference.outcomes[1]:
        reasons.append(f"the outcomes are {difference.outcomes[0]} and {difference.outcomes[1]}")
    if "objects" in keys or "step_time" in keys:
        reasons.append(f"{' and '.join(key for key in ('objects', 'step_time') if key in keys)} differ")
    return f"all steps that both runs have are equal, but {'; '.join(reasons)}"


def _shown(value: float | bool | None) -> str:
    if value is None:
        return "no number"
    return ("true" if value else "false") if isinstance(value, bool) else repr(value)
