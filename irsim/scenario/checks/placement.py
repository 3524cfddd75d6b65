"""Where objects start: on top of each other, or in ranges that make no sense."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from typing import Any

from irsim.diagnostics.diagnostic import Path
from irsim.options.vectors import is_vector
from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding, error, hint, warning
from irsim.scenario.model.scenario import Entry
from irsim.scenario.resolve.resolved import ObjectRecord

_NEAR = 1e-9
_MOST_ALIKE = 50
"""Obstacles in one place that are compared with each other."""


def check(context: Context) -> Iterator[Finding]:
    """By entry."""
    for path, entry, records in context.entries():
        name = entry.distribution.name if entry.distribution is not None else "manual"
        if name == "random":
            yield from _ranges(context, path)
        elif name == "circle" and len(records) > 1:
            yield from _circle(path, records)
        elif name == "manual" and len(records) > 1:
            yield from _stacked(path, entry, records)
    yield from _twice(context)


def _ranges(context: Context, path: Path) -> Iterator[Finding]:
    placement = next((p for p in context.resolved.placements if p.path == path), None)
    if placement is None:
        return
    for i, axis in enumerate(("x", "y", "theta")):
        low, high = placement.range_low[i], placement.range_high[i]
        if low > high:
            options: Any = context.entry(path).distribution
            key = "range_low" if options.range_low is not None else "range_high"
            given = getattr(options, key) is not None
            yield error(
                "range-order",
                (*path, "distribution", key) if given else (*path, "distribution"),
                f"{axis}: the lower bound {low:g} is above the upper bound {high:g}",
                given=getattr(options, key),
                fix="range_low must not be greater than range_high; the defaults end half a metre inside the world",
            )
            return


def _circle(path: Path, records: list[ObjectRecord]) -> Iterator[Finding]:
    a, b = records[0].state, records[1].state
    gap = math.hypot(a[0] - b[0], a[1] - b[1])
    widths = [2 * getattr(record.shape, "radius", 0.0) for record in records[:2] if record.shape.name == "circle"]
    if len(widths) == 2 and gap < sum(widths) / 2:
        yield warning(
            "circle-overlap",
            (*path, "distribution"),
            f"neighbours on the circle are {gap:.3g} m apart and overlap",
            fix="a larger 'radius', fewer objects or smaller ones",
        )


def _twice(context: Context) -> Iterator[Finding]:
    """The same obstacle written twice, in two entries."""
    drawn = {index for placement in context.resolved.placements for index in placement.objects}
    places: dict[tuple[float, ...], list[ObjectRecord]] = defaultdict(list)
    told: set[Path] = set()
    for record in context.written:
        if record.role == "robot" or not record.static or record.id in drawn or record.path in told:
            continue
        same = places[tuple(round(v, 9) for v in record.state[:3])]
        twin = next((other for other in same if other.path != record.path and other.shape == record.shape), None)
        if twin is None or getattr(record.shape, "random_shape", False) or twin.unobstructed != record.unobstructed:
            same[_MOST_ALIKE:] = []
            same.append(record)
            continue
        told.add(record.path)
        yield hint(
            "stacked",
            context.entry_path(record, "state") if context.given(record, "state") else record.path,
            f"'{record.name}' has the shape and the place of '{twin.name}': one of them is not needed",
            fix="another 'state', or one entry less",
        )


def _stacked(path: Path, entry: Entry, records: list[ObjectRecord]) -> Iterator[Finding]:
    if isinstance(entry.shape, list):  # polygons with vertices in world coordinates share a state on purpose
        return
    places: dict[tuple[float, ...], int] = defaultdict(int)
    for record in records:
        round_body = record.shape.name == "circle" and not any(record.shape.center)
        places[tuple(round(v, 9) for v in record.state[: 2 if round_body else 3])] += 1
    most = max(places.values())
    if most > 1:
        where = next(pose for pose, count in places.items() if count == most)
        key = "state" if entry.state is not None else "number"
        several = entry.state is not None and not is_vector(entry.state) and len(entry.state) > 1
        yield warning(
            "stacked",
            (*path, key),
            f"{most} objects of this entry start at the same place ({where[0]:g}, {where[1]:g})",
            fix=("a vector of its own in 'state' for each object" if several else "give 'state' one vector per object")
            + ", or a 'distribution': {name: random} or {name: circle}",
        )
