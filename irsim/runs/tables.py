"""What the views of a recorded run have in common: the request, the table, and its numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from irsim.runs.reading import Run
from irsim.scenario.limits import Limits
from irsim.simulation.trace import Trace

__all__ = ["Cell", "Field", "Question", "Table", "paged", "rounded"]

_DECIMALS = 4
"""Decimals of the numbers of a table."""
Cell = float | int | str | bool | None
Field = Literal["x", "y", "heading", "speed", "turn_rate", "control", "goal", "goal_distance", "nearest_hit", "status"]


@dataclass(frozen=True)
class Question:
    """A request for a table.

    Attributes:
        run, trace: The run and its trace.
        objects: Indices of the chosen objects: those that were named, or all robots.
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
        """Whether one of these objects was chosen, or none was named."""
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
