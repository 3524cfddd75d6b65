"""Tables of recorded runs: rows, collisions, speeds, and who watched and entered what."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

from irsim.common.text import listed, quoted
from irsim.runs.reading import Run
from irsim.scenario.limits import Limits
from irsim.simulation.events import Event
from irsim.simulation.trace import Trace

__all__ = [
    "ALL",
    "Cell",
    "Field",
    "Question",
    "Table",
    "chosen_objects",
    "paged",
    "rounded",
    "sight_empty_message",
    "sight_view",
    "zone_view",
    "zones_empty_message",
]

_DECIMALS = 4
"""Decimals of the numbers of a table."""
Cell = float | int | str | bool | None
Field = Literal[
    "x", "y", "heading", "speed", "turn_rate", "control", "goal", "goal_distance", "nearest_hit", "status", "readings"
]


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
    fields: Sequence[str]
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


_MAX_NAMES = 5
"""Number of zones or objects that a note names."""
_TIMES = ["step", "time", "to_step", "duration", "x", "y"]


class _Span(NamedTuple):
    """A visit or a sight.

    Attributes:
        begin: Event with which it begins.
        end: Step at which it ends; None if it lasts to the end of the run.
    """

    begin: Event
    end: int | None


def zone_view(asked: Question) -> Table:
    """Visits to regions and crossings of lines, in order of time."""
    events = [e for e in asked.run.events if e.zone is not None and asked.concerns(e.object)]
    rows = []
    for begin, end in _within(asked, _spans(events, "zone_exit")):
        times: list[Cell] = [*_times(asked, begin, end)]
        if begin.kind == "line_crossing":
            times[2:4] = [None, None]
        rows.append([begin.zone, begin.object, begin.direction or "inside", *times])
    return paged(asked, ["zone", "object", "what", *_TIMES], rows)


def sight_view(asked: Question) -> Table:
    """Who saw whom, in order of time; x and y are the place of the object that is seen."""
    kinds = ("sight_start", "sight_end")
    events = [e for e in asked.run.events if e.kind in kinds and asked.concerns(e.object, e.partner)]
    rows: list[list[Cell]] = [
        [begin.object, begin.partner, *_times(asked, begin, end)]
        for begin, end in _within(asked, _spans(events, "sight_end"))
    ]
    return paged(asked, ["observer", "seen", *_TIMES], rows)


def zones_empty_message(asked: Question) -> str:
    """Why the view of zones has no rows."""
    zones = [str(zone["name"]) for zone in asked.run.resolved["world"].get("zones") or ()]
    if not zones:
        return "the scenario has no world.zones, so no zone is watched"
    by = f" by {_chosen(asked)}" if asked.named else ""
    return f"none of the zones {_quoted_names(zones)} was entered or crossed{by} in {_span_of(asked)}"


def sight_empty_message(asked: Question) -> str:
    """Why the view of sights has no rows."""
    if not any(item.get("watches") for item in asked.run.resolved["objects"]):
        return "no object of the scenario has a fov, so no field of view is watched"
    chosen = f" by or with {_chosen(asked)}" if asked.named else ""
    return f"there is no sight{chosen} in {_span_of(asked)}"


def _chosen(asked: Question) -> str:
    return _quoted_names(sorted(asked.named or ()))


def _quoted_names(names: Sequence[str]) -> str:
    return listed([quoted(name) for name in names], _MAX_NAMES)


def _span_of(asked: Question) -> str:
    first, last = asked.steps
    return f"steps {first} to {last}"


def _spans(events: Iterable[Event], last: str) -> list[_Span]:
    """Match each event with the next one of the kind ``last`` about the same two; crossings end at once."""
    spans = list[_Span]()
    places: dict[tuple[str, str | None, str | None], int] = {}
    for event in events:
        key = event.object, event.partner, event.zone
        if event.kind == last:
            if (place := places.pop(key, None)) is not None:
                spans[place] = spans[place]._replace(end=event.step)
        elif event.kind == "line_crossing":
            spans.append(_Span(event, event.step))
        else:
            places[key] = len(spans)
            spans.append(_Span(event, None))
    return spans


def _within(asked: Question, spans: Iterable[_Span]) -> Iterable[_Span]:
    """The spans that have a part in the requested steps."""
    first, last = asked.steps
    return (span for span in spans if span.begin.step <= last and (span.end is None or span.end >= first))


def _times(asked: Question, begin: Event, end: int | None) -> list[Cell]:
    """Cells of :data:`_TIMES`; the end is empty, and the duration counts to the last step, if there is no end."""
    step_time = asked.trace.step_time
    last = int(asked.trace.step[-1]) if end is None else end
    duration = rounded((last - begin.step) * step_time)
    return [begin.step, rounded(begin.time), end, duration, rounded(begin.x), rounded(begin.y)]
