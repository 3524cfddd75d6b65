"""Checks `within` of the behavior ``follow``: one outline that encloses an area, with start and goals in it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from irsim.components.behaviors.follow import Follow
from irsim.diagnostics.diagnostic import Path
from irsim.options.regions import OUTLINES, Region
from irsim.scenario.checks._areas import check_polygon, check_rectangle
from irsim.scenario.checks._context import Context, distinct
from irsim.scenario.messages.findings import Finding, error, warning
from irsim.scenario.resolve.resolved import ObjectRecord


def check(context: Context) -> Iterator[Finding]:
    """Check the behaviors of all objects; one finding per path and code."""
    random = {number for placement in context.resolved.placements for number in placement.objects}
    for record in context.entry_objects:
        for key in ("behavior", "group_behavior"):
            options = getattr(record, key)
            if isinstance(options, Follow) and options.within is not None:
                path = (*context.entry_path(record, key), "within")
                found = list(_outline(path, options.within))
                known = record.id not in random
                yield from distinct(found or (_ends(path, record, options.within) if known else ()))


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
