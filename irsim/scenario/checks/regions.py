"""Checks `within` and `avoid` of the behavior ``follow``.

`within` is one outline that encloses an area, with start and goals in it. `avoid` names zones, in which neither start
nor goals are.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence

from irsim.components.behaviors.follow import Follow
from irsim.diagnostics.diagnostic import Edit, Path, nearest
from irsim.options.regions import OUTLINES, Region
from irsim.scenario.checks._context import Context, distinct
from irsim.scenario.checks._outlines import check_polygon, check_rectangle
from irsim.scenario.messages.findings import Finding, error, warning
from irsim.scenario.model.zones import OUTLINES as ZONE_OUTLINES
from irsim.scenario.model.zones import Zone
from irsim.scenario.resolve.resolved import ObjectRecord

_MAX_NAMES = 12
"""Largest number of names that a message lists."""


def check(context: Context) -> Iterator[Finding]:
    """Check the behaviors of all objects; one finding per path and code."""
    random = {number for placement in context.resolved.placements for number in placement.objects}
    for record in context.entry_objects:
        for key in ("behavior", "group_behavior"):
            options = getattr(record, key)
            if not isinstance(options, Follow):
                continue
            entry_path, known = context.entry_path(record, key), record.id not in random
            if options.within is not None:
                path = (*entry_path, "within")
                findings = list(_outline(path, options.within))
                yield from distinct(findings or (_ends(path, record, options.within) if known else ()))
            yield from _avoided(context, (*entry_path, "avoid"), record, options, known)


def _avoided(context: Context, path: Path, record: ObjectRecord, options: Follow, known: bool) -> Iterator[Finding]:
    """Zones that do not exist, and zones in which an object starts or has a goal."""
    zones = {zone.name: zone for zone in context.scenario.world.zones}
    for index, name in enumerate(options.avoid):
        where = (*path, index)
        if name not in zones:
            yield unknown_zone(where, name, zones)
        elif known:
            yield from _ends_in_zone(where, record, zones[name])


def unknown_zone(where: Path, name: str, zones: Collection[str]) -> Finding:
    """The finding about a name that no zone has.

    Args:
        where: Path of the name.
        name: The name.
        zones: Names of the zones of the world.
    """
    near = nearest(name, zones)
    return error(
        "unknown-zone",
        where,
        f"no zone is called '{name}'" + ("" if zones else ": world.zones is empty"),
        given=name,
        allowed=list(zones)[:_MAX_NAMES] or None,
        fix=f"write '{near}'"
        if near
        else f"world: {{zones: [{{name: {name}, circle: {{center: [x, y], radius: r}}}}]}} makes it",
        edit=Edit("replace", where, near) if near else None,
    )


def ends_fit(options: Follow, places: Sequence[Sequence[float]], zones: Sequence[Zone], radius: float) -> bool:
    """Whether a start and goals are in the region of `within` and not in the zones that are avoided.

    Args:
        options: The behavior.
        places: x, y of the start and of each goal [m].
        zones: The avoided zones, each with one outline.
        radius: Radius of the object if it is a circle, otherwise 0 [m].
    """
    inside = options.within is None or all(_is_inside(options.within.points, *place[:2]) for place in places)
    return inside and all(_distance(zone, *place[:2]) > radius for zone in zones for place in places)


def _ends_in_zone(path: Path, record: ObjectRecord, zone: Zone) -> Iterator[Finding]:
    """A start or goal in a zone that the object avoids: there is no path to such a goal."""
    if len([key for key in ZONE_OUTLINES if getattr(zone, key) is not None]) != 1:
        return  # another check reports it
    radius = record.shape.radius if record.shape.name == "circle" else 0.0
    for what, place in (("start", record.state), *(("goal", goal) for goal in record.goals)):
        if (what == "goal" and record.wander) or _distance(zone, place[0], place[1]) > radius:
            continue
        yield warning(
            "ends-in-zone",
            path,
            f"'{record.name}' avoids the zone '{zone.name}', but "
            + (
                "starts in it" if what == "start" else f"its goal ({place[0]:g}, {place[1]:g}) is in it: it has no path"
            ),
            fix=f"move the {what} or the zone apart, or leave '{zone.name}' out of 'avoid'",
        )
        return


def _distance(zone: Zone, x: float, y: float) -> float:
    """Distance of a point from a zone [m]; 0 or less inside."""
    if zone.circle is not None:
        return math.dist(zone.circle.center, (x, y)) - zone.circle.radius
    points = zone.points
    if not zone.is_line and _is_inside(points, x, y):
        return 0.0
    ends = points[1:] if zone.is_line else [*points[1:], points[0]]
    return min(_distance_to_segment(a, b, x, y) for a, b in zip(points, ends, strict=False))


def _distance_to_segment(a: Sequence[float], b: Sequence[float], x: float, y: float) -> float:
    along = (b[0] - a[0], b[1] - a[1])
    length = along[0] ** 2 + along[1] ** 2
    share = ((x - a[0]) * along[0] + (y - a[1]) * along[1]) / length if length else 0.0
    share = min(max(share, 0.0), 1.0)
    return math.dist((a[0] + share * along[0], a[1] + share * along[1]), (x, y))


def _outline(path: Path, region: Region) -> Iterator[Finding]:
    given = [key for key in OUTLINES if getattr(region, key) is not None]
    if not given:
        yield error(
            "missing-key",
            path,
            "the region has no outline",
            allowed=OUTLINES,
            fix="add 'rectangle: [x_min, y_min, x_max, y_max]' or 'polygon: [[x, y], [x, y], [x, y]]'",
        )
    elif len(given) > 1:
        message = "'polygon' and 'rectangle' exclude each other: each says where the region is"
        yield error("conflicting-keys", (*path, given[1]), message, fix="keep one of them")
    elif region.rectangle is not None:
        yield from check_rectangle((*path, "rectangle"), region.rectangle)
    elif region.polygon is not None:
        yield from check_polygon((*path, "polygon"), region.polygon)


def _ends(path: Path, record: ObjectRecord, region: Region) -> Iterator[Finding]:
    """A start or goal outside the region: there is no path to such a goal."""
    corners = region.points
    for what, place in (("start", record.state), *(("goal", goal) for goal in record.goals)):
        if what == "goal" and record.wander:
            continue
        if not _is_inside(corners, place[0], place[1]):
            message = f"the {what} ({place[0]:g}, {place[1]:g}) of '{record.name}' is not in this region"
            yield warning(
                "region-left",
                path,
                message + (": it has no path to it" if what == "goal" else ""),
                fix="widen 'within' so that it holds start and goals",
            )
            return


def _is_inside(corners: Sequence[Sequence[float]], x: float, y: float) -> bool:
    inside = False
    for (ax, ay), (bx, by) in zip(corners, [*corners[1:], corners[0]], strict=True):
        if (ay > y) != (by > y) and x < ax + (bx - ax) * (y - ay) / (by - ay):
            inside = not inside
    return inside
