"""Differences in motion between two scenarios that were tried with the same seed."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from irsim.common.text import clean, listed, metres, seconds
from irsim.results.episode import EventRecord
from irsim.validation.dry_run import Trial

__all__ = ["motion_changes"]

_SAME_M = 1e-6
"""Distance up to which two positions are the same [m]."""
_MAX_NAMED = 6
"""Number of objects that a line names."""


def motion_changes(before: Trial, after: Trial) -> list[str]:
    """Compare how objects move in two trials; collisions come first. Empty if everything moves alike.

    Args:
        before: Trial of the first scenario.
        after: Trial of the second one, with the same seed.
    """
    return [*_collisions(before, after), *_arrivals(before, after), *_stuck(before, after), *_paths(before, after)]


def _collisions(before: Trial, after: Trial) -> list[str]:
    was, now = (_pairs(trial.result.collisions) for trial in (before, after))
    lines = [f"new: {_hit(event)}" for pair, event in now.items() if pair not in was]
    lines += [f"no longer: {_hit(event)}" for pair, event in was.items() if pair not in now]
    return [*lines, *(f"as in base: {_hit(event)}" for pair, event in now.items() if pair in was)]


def _pairs(events: Iterable[EventRecord]) -> dict[frozenset[str], EventRecord]:
    """The first collision of each pair of objects."""
    first: dict[frozenset[str], EventRecord] = {}
    for event in events:
        first.setdefault(frozenset((event.object, event.partner or "")), event)
    return first


def _hit(event: EventRecord) -> str:
    place = f"at {seconds(event.time)} near ({event.x:.2f}, {event.y:.2f})"
    return f"'{clean(event.object)}' hits '{clean(event.partner or '')}' {place}"


def _arrivals(before: Trial, after: Trial) -> list[str]:
    was, now = _arrival_times(before), _arrival_times(after)
    robots = [*after.result.arrived, *(name for name in before.result.arrived if name not in now)]
    lines = []
    for name in dict.fromkeys(robots):
        if name in was and name in now and abs(was[name] - now[name]) > after.trace.step_time / 2:
            lines.append(f"'{clean(name)}' arrives at {seconds(now[name])}, in base at {seconds(was[name])}")
        elif name not in was and name in before.trace.names:
            lines.append(f"'{clean(name)}' arrives at {seconds(now[name])}, in base not within the time tried")
        elif name not in now and name in after.trace.names:
            lines.append(f"'{clean(name)}' does not arrive within the time tried, in base at {seconds(was[name])}")
    return lines


def _arrival_times(trial: Trial) -> dict[str, float]:
    """Time at which each robot that arrived did so [s]."""
    trace, names = trial.trace, list(trial.trace.names)
    columns = {name: trace.arrived[:, names.index(name)] for name in trial.result.arrived}
    return {name: float(trace.time[int(np.argmax(flags))]) for name, flags in columns.items() if flags.any()}


def _stuck(before: Trial, after: Trial) -> list[str]:
    was = {item.name for item in before.result.stuck}
    lines = [
        f"new: '{clean(item.name)}' {item.doing} since {seconds(item.since)}: {clean(item.why)}"
        for item in after.result.stuck
        if item.name not in was
    ]
    gone = {item.name for item in before.result.left}
    return lines + [
        f"new: '{clean(item.name)}' leaves the world at {seconds(item.time)}"
        for item in after.result.left
        if item.name not in gone
    ]


def _paths(before: Trial, after: Trial) -> list[str]:
    """Which objects take other paths, from when on, and by how much."""
    a, b = before.trace, after.trace
    if a.step_time != b.step_time:
        return [f"steps take {b.step_time:g} s, in base {a.step_time:g} s, so paths are not compared"]
    steps = min(len(a), len(b))
    apart = list[tuple[float, str, float]]()
    for column, name in enumerate(b.names):
        if name not in a.names:
            continue
        pair = a.pose[:steps, a.names.index(name)], b.pose[:steps, column]
        if not any(np.nanmax(np.ptp(path, axis=0), initial=0.0) > _SAME_M for path in pair):
            continue  # it stands still in both
        distance = np.nan_to_num(np.linalg.norm(pair[0][:, :2] - pair[1][:, :2], axis=1))
        turned = np.nan_to_num(np.abs(pair[0][:, 2] - pair[1][:, 2])) > _SAME_M
        differ = np.flatnonzero((distance > _SAME_M) | turned)
        if differ.size:
            apart.append((float(distance.max()), name, float(b.time[differ[0]])))
    if not apart:
        return []
    apart.sort(key=lambda item: -item[0])
    named = [f"'{clean(name)}' from {seconds(since)} on, up to {metres(most)} apart" for most, name, since in apart]
    return [f"other paths: {listed(named, _MAX_NAMED)}"]
