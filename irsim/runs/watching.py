"""Tables of what was watched in a recorded run: visits to zones, and who saw whom."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from irsim.common.text import listed, quoted
from irsim.runs.tables import Cell, Question, Table, paged, rounded
from irsim.simulation.events import Event

__all__ = ["sight_empty_message", "sight_view", "zone_view", "zones_empty_message"]

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
    return f"none of the zones {_named(zones)} was entered or crossed{by} in {_span_of(asked)}"


def sight_empty_message(asked: Question) -> str:
    """Why the view of sights has no rows."""
    if not any(item.get("watches") for item in asked.run.resolved["objects"]):
        return "no object of the scenario has a fov, so no field of view is watched"
    chosen = f" by or with {_chosen(asked)}" if asked.named else ""
    return f"there is no sight{chosen} in {_span_of(asked)}"


def _chosen(asked: Question) -> str:
    return _named(sorted(asked.named or ()))


def _named(names: Sequence[str]) -> str:
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
