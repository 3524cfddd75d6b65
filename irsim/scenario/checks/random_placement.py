"""Finds random placements that cannot, or can hardly, succeed; by arithmetic, before any draw."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from irsim.common.text import metres
from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding, error, warning
from irsim.scenario.resolve.resolved import ObjectRecord, Placement

_MAX_POINTS = 1e15
"""Number of points that the bound is cut to, so that it stays an exact integer."""
_MAX_DENSITY = 0.5
"""Share of the area above which random placement of discs mostly fails; its limit is 0.547."""
_MAX_DISTANCE_SHARE = 0.85
"""Share of the diagonal of the range above which a `goal_distance` leaves little room."""
_MAX_BAND_DENSITY = 0.4
"""The same for a band around a circle; measured, with 1000 draws for each object: from here on some seeds fail."""


def check(context: Context) -> Iterator[Finding]:
    """Check each random placement."""
    for placement in context.resolved.placements:
        records = [context.resolved.objects[index] for index in placement.objects]
        if placement.distribution == "random":
            yield from _check_goal_distance(placement)
        if len(records) > 1 and placement.distribution == "random":
            yield from _check_density(placement, records)
        elif records and placement.distribution != "random":
            yield from _check_crossing(placement, records)


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


def _check_goal_distance(placement: Placement) -> Iterator[Finding]:
    wanted = float(placement.options["goal_distance"])
    width, height = (placement.range_high[i] - placement.range_low[i] for i in range(2))
    longest = math.hypot(width, height)
    if wanted <= _MAX_DISTANCE_SHARE * longest or width < 0 or height < 0:
        return
    impossible = wanted > longest
    yield (error if impossible else warning)(
        "placement-impossible" if impossible else "placement-tight",
        (*placement.path, "distribution", "goal_distance"),
        f"goals must be {wanted:g} m from their starts, and the range is {metres(longest)} from corner to corner"
        + ("" if impossible else ": starts and goals all lie near opposite corners"),
        given=wanted,
        fix=f"goal_distance: {0.7 * longest:.2g} or less, or a larger range (range_low to range_high)",
    )


def _check_crossing(placement: Placement, records: list[ObjectRecord]) -> Iterator[Finding]:
    """Starts, and goals, of objects that cross are discs that must not overlap, in a band or a square."""
    options = placement.options
    distance = min(_thickness(record.shape) for record in records) + options["clearance"]
    if placement.distribution == "circle_crossing":  # starts and goals keep clear of one another
        count, limit = 2 * len(records), _MAX_BAND_DENSITY
        band = _band(options["radius"], options["noise"] + distance / 2)
        most = _band(options["radius"], math.sqrt(2) * options["noise"] + distance / 2)  # the corners of the noise
    else:
        count, limit = len(records), _MAX_DENSITY
        band = most = (options["width"] + distance) ** 2
    ground = count * math.pi / 4 * distance**2
    if distance <= 0 or ground <= limit * band:
        return
    impossible = ground > most
    yield (error if impossible else warning)(
        "placement-impossible" if impossible else "placement-tight",
        (*placement.path, "distribution"),
        f"{len(records)} objects must keep {distance:g} m between their centres in {placement.room}: they cover "
        f"{ground / (most if impossible else band):.0%} of it, and random placement gets stuck at about {limit:.0%}",
        given=len(records),
        fix=f"use fewer or smaller objects, a smaller 'clearance' (now {options['clearance']:g} m), or "
        + placement.widen,
    )


def _band(radius: float, reach: float) -> float:
    """Area within a distance of a circle [m2]."""
    return math.pi * ((radius + reach) ** 2 - max(radius - reach, 0.0) ** 2)


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
