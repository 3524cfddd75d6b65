"""Tables about a recorded run: the request, the objects that it is about, the table and its numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from irsim.runs.reading import Run
from irsim.scenario.limits import Limits
from irsim.simulation.trace import Trace

__all__ = ["ALL", "Cell", "Field", "Question", "Table", "chosen_objects", "paged", "rounded"]


_DECIMALS = 4
"""Decimals of the numbers of a table."""
Cell = float | int | str | bool | None
Field = Literal["x", "y", "heading", "speed", "turn_rate", "control", "goal", "goal_distance", "nearest_hit", "status"]


@dataclass(frozen=True)
class Question:
    """A request for a table.

    Attributes:
        run, trace: The run and its trace.
        objects: Indices of the chosen objects: the named ones, or all robots.
        named: Names of the chosen objects, None for all.
        first, last: First and last row of the trace.
        every: Take every Nth row; None: as many rows as fit.
        fields: Columns of the view ``rows``.
        start: Number of the first row of the page.
        limit: Greatest number of rows of the page, None for all.
        limits: Limits of the reader of the scenario.
    """

    run: Run
    trace: Trace
    objects: list[int]
    named: frozenset[str] | None
    first: int
    last: int
    every: int | None
    fields: Sequence[Field]
    start: int
    limit: int | None
    limits: Limits | None

    def concerns(self, *names: str | None) -> bool:
        """Whether one of these objects was chosen, or no name was given."""
        return self.named is None or any(name in self.named for name in names)

    @property
    def steps(self) -> tuple[int, int]:
        """First and last step."""
        return int(self.trace.step[self.first]), int(self.trace.step[self.last])


@dataclass(frozen=True)
class Table:
    """A page of a table of ``total`` rows."""

    columns: list[str]
    rows: list[list[Cell]]
    total: int
    every: int = 1


def paged(asked: Question, columns: list[str], rows: list[list[Cell]]) -> Table:
    """Cut the requested page out of all rows."""
    stop = None if asked.limit is None else asked.start + asked.limit
    return Table(columns, rows[asked.start : stop], len(rows))


def rounded(value: float) -> float | None:
    """A number rounded to four decimals; None if it is not finite."""
    return round(float(value), _DECIMALS) if math.isfinite(value) else None


ALL = "all"
"""Stands for all objects that can move."""
_ROLES = {"robot": "robot", "robots": "robot", "obstacle": "obstacle", "obstacles": "obstacle"}


def chosen_objects(run: Run, asked: str | None) -> tuple[list[int], frozenset[str] | None]:
    """Return the indices of the chosen objects, and their names if only these are wanted in lists of events.

    Args:
        run: The run.
        asked: Name of an object, ``all`` (all that can move), ``robots``, ``obstacles`` (moving ones), a tag,
            or several of these, separated by commas; None for all robots, and all objects in lists of events. The name
            of an object goes before its other meanings.

    Raises:
        RunError: There is no such object.
    """
    objects = run.resolved["objects"]
    if asked is None:
        return [index for index, item in enumerate(objects) if item.get("role") == "robot"], None
    rows: dict[int, None] = {}
    words = [asked] if asked in run.names else [word.strip() for word in asked.split(",") if word.strip()] or [asked]
    for word in words:
        rows.update(dict.fromkeys(_named(run, word)))
    return sorted(rows), None if words == [ALL] and ALL not in run.names else frozenset(run.names[k] for k in rows)


def _named(run: Run, word: str) -> list[int]:
    """Return the indices of the objects that one word means."""
    objects = run.resolved["objects"]
    if word in run.names:
        return [run.index_of(word)]
    movable = [k for k, item in enumerate(objects) if item.get("kinematics") is not None and not item.get("static")]
    if word == ALL:
        return [k for k, item in enumerate(objects) if k in movable or item.get("role") == "robot"]
    if word in _ROLES:
        wanted = _ROLES[word]
        return [
            k for k, item in enumerate(objects) if item.get("role") == wanted and (k in movable or wanted == "robot")
        ]
    tagged = [k for k, item in enumerate(objects) if word in (item.get("tags") or [])]
    return tagged or [run.index_of(word)]
