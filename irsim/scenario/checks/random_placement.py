"""Random placements that cannot succeed, or hardly: by arithmetic, before any draw."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding, error, warning
from irsim.scenario.resolve.resolved import ObjectRecord, Placement

_COUNTABLE = 1e15
_JAM = 0.5
"""Share of the ground from which random placement of discs mostly fails; it cannot pass 0.547."""


def check(context: Context) -> Iterator[Finding]:
    """One finding per placement."""
    for placement in context.resolved.placements:
        records = [context.resolved.objects[index] for index in placement.objects]
        if len(records) > 1:
            yield from _crowded(placement, records)


def _crowded(placement: Placement, records: list[ObjectRecord]) -> Iterator[Finding]:
    width, height = (placement.range_high[i] - placement.range_low[i] for i in range(2))
    distance = max(placement.min_distance, min(_thickness(record.shape) for record in records))
    if width < 0 or height < 0 or distance <= 0:
        return
    count, most = len(records), most_points(width, height, distance)
    density = count * math.pi / 4 / ((width / distance + 1) * (height / distance + 1))
    why = f"{count} objects keep {distance:g} m between their middles"
    room = f"middles may lie in {width:g} m × {height:g} m (range_low to range_high)"
    fix = f"fewer objects, smaller ones, a smaller 'min_distance' (now {placement.min_distance:g} m), or a larger range"
    path = (*placement.path, "distribution")
    if count > most:
        yield error(
            "placement-impossible",
            path,
            f"{why}, but no arrangement holds more than {most}: {room}",
            given=count,
            fix=fix,
        )
    elif density > _JAM:
        yield warning(
            "placement-tight",
            path,
            f"{why}: they cover {density:.0%} of the ground, and random placement gets stuck at about half; {room}",
            given=count,
            fix=fix,
        )


def most_points(width: float, height: float, distance: float) -> int:
    """No rectangle holds more points at this mutual distance (Groemer 1960: a bound for convex regions)."""
    along, up = width / distance, height / distance
    return math.floor(min(2 / math.sqrt(3) * along * up + along + up + 1 + 1e-9, _COUNTABLE))


def _thickness(shape: Any) -> float:
    """Middles of two such bodies that do not overlap are at least this far apart [m]; 0 where nothing is known."""
    if shape.name == "circle":
        return float(2 * (shape.radius_range[0] if shape.random_shape else shape.radius))
    if shape.name == "rectangle" and shape.wheelbase is None:
        return float(min(shape.length, shape.width))
    return 0.0
