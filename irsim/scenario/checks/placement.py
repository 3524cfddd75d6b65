"""Checks where objects start: several in one place, circles that are too small, ranges that are empty."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from typing import Any

from irsim.common.text import metres
from irsim.diagnostics.diagnostic import Edit, Path, nearest
from irsim.options.vectors import is_vector
from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding, error, hint, warning
from irsim.scenario.model.scenario import Entry
from irsim.scenario.resolve.expand import named
from irsim.scenario.resolve.resolved import ObjectRecord, Placement

_PLANE = 2
"""Number of coordinates of a point."""
_MAX_NAMES = 12
"""Largest number of names that a message lists."""
_MAX_ALIKE = 50
"""Largest number of obstacles at one place with which a further obstacle is compared."""


def check(context: Context) -> Iterator[Finding]:
    """Check each entry, then all static obstacles together."""
    for path, entry, records in context.entries():
        name = entry.distribution.name if entry.distribution is not None else "manual"
        if name == "random":
            yield from _empty_ranges(context, path)
            yield from _keep_clear(context, path, entry.distribution)
        elif name == "circle":
            yield from _third_number(path, entry.distribution)
            if len(records) > 1:
                yield from _overlap_on_circle(path, records)
        elif name == "manual" and len(records) > 1:
            yield from _stacked_objects(path, entry, records)
    yield from _duplicate_obstacles(context)
    yield from _room(context)


def _empty_ranges(context: Context, path: Path) -> Iterator[Finding]:
    placement = next((p for p in context.resolved.placements if p.path == path), None)
    if placement is None:
        return
    options: Any = context.entry(path).distribution
    for what, lows, highs in placement.ranges:
        for i, axis in enumerate(("x", "y", "theta")):
            low, high = lows[i], highs[i]
            if low > high:
                key = f"{what}_low" if getattr(options, f"{what}_low") is not None else f"{what}_high"
                given = getattr(options, key) is not None
                yield error(
                    "range-order",
                    (*path, "distribution", key) if given else (*path, "distribution"),
                    f"{axis}: the lower bound must not exceed the upper bound, got {low:g} and {high:g}",
                    given=getattr(options, key),
                    fix=f"lower {what}_low or raise {what}_high; the defaults end half a metre inside the world",
                )
                return


def _keep_clear(context: Context, path: Path, options: Any) -> Iterator[Finding]:
    """Items of `keep_clear` with nothing, or two things, to keep clear of, or an object that cannot make way."""
    placements = context.resolved.placements
    own = next((index for index, placement in enumerate(placements) if placement.path == path), None)
    unknown = set() if own is None else set(placements[own].objects)
    for placement in placements[own or 0 :]:
        if placement.distribution != "random":
            unknown.update(placement.objects)
    for index, item in enumerate(options.keep_clear):
        where = (*path, "distribution", "keep_clear", index)
        if (item.point is None) == (item.object is None):
            both = item.point is not None
            message = "'point' and 'object' exclude each other" if both else "there is nothing to keep clear of"
            yield error("keep-clear", where, message, fix="give either 'point: [x, y]' or 'object: NAME'")
        elif item.object is not None:
            yield from _kept_object(context, (*where, "object"), item.object, unknown)


def _kept_object(context: Context, path: Path, name: str, unknown: set[int]) -> Iterator[Finding]:
    records = named(context.entry_objects, name)
    if not records:
        known = {word: None for record in context.entry_objects for word in (record.name, record.group_name)}
        near = nearest(name, known)
        yield error(
            "unknown-object",
            path,
            f"no object or group is called '{name}'",
            given=name,
            allowed=list(known)[:_MAX_NAMES],
            fix=f"object: {near}" if near else None,
            edit=Edit("replace", path, near) if near else None,
        )
    elif blocking := [record for record in records if record.id in unknown]:
        own = blocking[0].path == path[: len(blocking[0].path)]
        if own:
            message = f"'{name}' is placed by this same entry: keep_clear is about other entries"
            fix = "min_distance: its objects keep this distance from each other"
        else:
            message = f"'{name}' is placed after this entry, on its circle or square, and cannot make way for it"
            fix = f"write the entry of '{name}' before this one, or give it 'distribution: {{name: random}}'"
        yield error("keep-clear", path, message, given=name, fix=fix)


def _third_number(path: Path, options: Any) -> Iterator[Finding]:
    """A third number of `center`, which looks like an angle."""
    if options.center is not None and len(options.center) > _PLANE and options.center[_PLANE] != 0:
        where = (*path, "distribution", "center", _PLANE)
        yield hint(
            "ignored-key",
            where,
            "the third number of 'center' has no effect",
            given=options.center[_PLANE],
            fix=f"start_angle: {options.center[_PLANE]:g} turns the objects around the circle",
        )


def _overlap_on_circle(path: Path, records: list[ObjectRecord]) -> Iterator[Finding]:
    a, b = records[0].state, records[1].state
    gap = math.hypot(a[0] - b[0], a[1] - b[1])
    widths = [2 * getattr(record.shape, "radius", 0.0) for record in records[:2] if record.shape.name == "circle"]
    if len(widths) == 2 and gap < sum(widths) / 2:
        yield warning(
            "circle-overlap",
            (*path, "distribution"),
            f"neighbours on the circle are {metres(gap)} apart and overlap",
            fix="use a larger 'radius', or fewer or smaller objects",
        )


def _duplicate_obstacles(context: Context) -> Iterator[Finding]:
    """Static obstacles with the same shape and place as one of another entry."""
    random = {index for placement in context.resolved.placements for index in placement.objects}
    places: dict[tuple[float, ...], list[ObjectRecord]] = defaultdict(list)
    reported: set[Path] = set()
    for record in context.entry_objects:
        if record.role == "robot" or not record.static or record.id in random or record.path in reported:
            continue
        same = places[tuple(round(v, 9) for v in record.state[:3])]
        twin = next((other for other in same if other.path != record.path and other.shape == record.shape), None)
        if twin is None or getattr(record.shape, "random_shape", False) or twin.unobstructed != record.unobstructed:
            same[_MAX_ALIKE:] = []
            same.append(record)
            continue
        reported.add(record.path)
        yield hint(
            "stacked",
            context.entry_path(record, "state") if context.is_given(record, "state") else record.path,
            f"'{record.name}' has the same shape and place as '{twin.name}': one of them is not needed",
            fix="change 'state', or remove one of the two",
        )


def _stacked_objects(path: Path, entry: Entry, records: list[ObjectRecord]) -> Iterator[Finding]:
    if isinstance(entry.shape, list):  # polygons with vertices in world coordinates share one state on purpose
        return
    places: dict[tuple[float, ...], int] = defaultdict(int)
    for record in records:
        round_body = record.shape.name == "circle" and not any(record.shape.center)
        pose = tuple(round(v, 9) for v in record.state[: 2 if round_body else 3])
        places[(*pose, record.appear_time)] += 1  # objects that appear at different times do not stack
    most = max(places.values())
    if most > 1:
        where = next(pose for pose, count in places.items() if count == most)
        key = "state" if entry.state is not None else "number"
        several = entry.state is not None and not is_vector(entry.state) and len(entry.state) > 1
        yield warning(
            "stacked",
            (*path, key),
            f"{most} objects of this entry start at the same place ({where[0]:g}, {where[1]:g})",
            fix=("give each object its own vector in 'state'" if several else "give 'state' one vector per object")
            + ", or a 'distribution': {name: random} or {name: circle}",
        )


_MAX_POINTS = 1e15
"""Number of points that the bound is cut to, so that it stays an exact integer."""
_MAX_DENSITY = 0.5
"""Share of the area above which random placement of discs mostly fails; its limit is 0.547."""
_MAX_DISTANCE_SHARE = 0.85
"""Share of the diagonal of the range above which a `goal_distance` leaves little room."""
_MAX_BAND_DENSITY = 0.4
"""The same for a band around a circle; measured, with 1000 draws for each object: from here on some seeds fail."""


def _room(context: Context) -> Iterator[Finding]:
    """Check whether each random placement has room, by arithmetic, before any draw."""
    for placement in context.resolved.placements:
        records = [context.resolved.objects[index] for index in placement.objects]
        if placement.distribution == "random":
            yield from _check_goal_distance(placement)
        if len(records) > 1 and placement.distribution == "random":
            for what, low, high in placement.ranges:
                yield from _check_density(placement, records, what, low, high)
        elif records and placement.distribution != "random":
            yield from _check_crossing(placement, records)


def _check_density(
    placement: Placement, records: list[ObjectRecord], what: str, low: list[float], high: list[float]
) -> Iterator[Finding]:
    width, height = high[0] - low[0], high[1] - low[1]
    distance = max(placement.min_distance, min(_thickness(record.shape) for record in records))
    if width < 0 or height < 0 or distance <= 0:
        return
    count, most = len(records), max_points(width, height, distance)
    density = count * math.pi / 4 / ((width / distance + 1) * (height / distance + 1))
    why = f"{count} objects must keep {distance:g} m between their {'goals' if what == 'goal' else 'centres'}"
    area = (
        f"{'they' if what == 'goal' else 'centres'} may lie in {width:g} m × {height:g} m ({what}_low to {what}_high)"
    )
    fix = (
        f"use fewer or smaller objects, a smaller 'min_distance' (now {placement.min_distance:g} m), or a larger range"
    )
    path = (*placement.path, "distribution")
    if count > most:
        yield error("placement-crowded", path, f"{why}, but at most {most} can: {area}", given=count, fix=fix)
    elif density > _MAX_DENSITY:
        yield warning(
            "placement-tight",
            path,
            f"{why}: they cover {density:.0%} of the area, and random placement gets stuck at about half; {area}",
            given=count,
            fix=fix,
        )


def _check_goal_distance(placement: Placement) -> Iterator[Finding]:
    wanted, ranges = float(placement.options["goal_distance"]), placement.ranges
    (_, low, high), (_, goal_low, goal_high) = ranges[0], ranges[-1]
    longest = math.hypot(*(max(goal_high[i] - low[i], high[i] - goal_low[i]) for i in range(_PLANE)))
    empty = any(lows[i] > highs[i] for _, lows, highs in ranges for i in range(_PLANE))
    if wanted <= _MAX_DISTANCE_SHARE * longest or empty:
        return
    impossible, apart = wanted > longest, len(ranges) > 1
    where = (
        f"they lie at most {metres(longest)} apart"
        if apart
        else f"the range is {metres(longest)} from corner to corner"
    )
    yield (error if impossible else warning)(
        "placement-crowded" if impossible else "placement-tight",
        (*placement.path, "distribution", "goal_distance"),
        f"goals must be {wanted:g} m from their starts, and {where}"
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
        "placement-crowded" if impossible else "placement-tight",
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
