"""Finds random placements that cannot, or can hardly, succeed; by arithmetic, before any draw."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding, error, warning
from irsim.scenario.resolve.resolved import ObjectRecord, Placement

_MAX_POINTS = 1e15
"""Number of points that the bound is cut to, so that it stays an exact integer."""
_MAX_DENSITY = 0.5
"""Share of the area above which random placement of discs mostly fails; its limit is 0.547."""


def check(context: Context) -> Iterator[Finding]:
    """Check each random placement."""
    for placement in context.resolved.placements:
        records = [context.resolved.objects[index] for index in placement.objects]
        if len(records) > 1:
            yield from _check_density(placement, records)


def _check_density(placement: Placement, records: list[ObjectRecord]) -> Iterator[Finding]:
    width, height = (placement.range_high[i] - placement.range_low[i] for i in range(2))
    distance = max(placement.min_distance, min(_thickness(record.shape) for record in records))
    if width < 0 or height < 0 or distance <= 0:
        return
    count, most = len(records), max_points(width, height, distance)
    density = count * math.pi / 4 / ((width / distance + 1) * (height / distance + 1))
    why = f"{count} objects must keep {distance:g} m between their centres"
    area = f"centres may lie in {width:g} m × {height:g} m (range_low to range_high)"
    fix = (
        f"use fewer or smaller objects, a smaller 'min_distance' (now {placement.min_distance:g} m), or a larger range"
    )
    path = (*placement.path, "distribution")
    if count > most:
        yield error(
            "placement-impossible",
            path,
            f"{why}, but at most {most} can: {area}",
            given=count,
            fix=fix,
        )
    elif density > _MAX_DENSITY:
        yield warning(
            "placement-tight",
            path,
            f"{why}: they cover {density:.0%} of the area, and random placement gets stuck at about half; {area}",
            given=count,
            fix=fix,
        )


def max_points(width: float, height: float, distance: float) -> int:
    """Upper bound of the points in a rectangle at this mutual distance (Groemer 1960, for convex regions)."""
    along, up = width / distance, height / distance
    return math.floor(min(2 / math.sqrt(3) * along * up + along + up + 1 + 1e-9, _MAX_POINTS))


def _thickness(shape: Any) -> float:
    """Smallest distance of the centres of two such bodies that do not overlap [m]; 0 if unknown."""
    if shape.name == "circle":
        return float(2 * (shape.radius_range[0] if shape.random_shape else shape.radius))
    if shape.name == "rectangle" and shape.wheelbase is None:
        return float(min(shape.length, shape.width))
    return 0.0
