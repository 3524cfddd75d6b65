"""Checks ``world.zones``: names, exactly one outline each, outlines that enclose an area, places outside the world."""

from __future__ import annotations

from collections.abc import Iterator

from irsim.diagnostics.diagnostic import Path
from irsim.scenario.checks._context import Context
from irsim.scenario.checks._outlines import check_polygon, check_rectangle
from irsim.scenario.messages.findings import Finding, error, warning
from irsim.scenario.model.zones import OUTLINES, Zone


def check(context: Context) -> Iterator[Finding]:
    """Check each zone."""
    first: dict[str, int] = {}
    for index, zone in enumerate(context.scenario.world.zones):
        path: Path = ("world", "zones", index)
        other = first.setdefault(zone.name, index)
        if other != index:
            yield error(
                "duplicate-name",
                (*path, "name"),
                f"the name '{zone.name}' is already taken by zone {other}",
                given=zone.name,
                fix="give each zone a name of its own",
            )
        given = [key for key in OUTLINES if getattr(zone, key) is not None]
        if len(given) == 1:
            findings = list(_outline(path, zone))
            yield from findings or _outside(context, path, zone)
        elif not given:
            yield error(
                "missing-key",
                path,
                f"zone '{zone.name}' has no place",
                allowed=OUTLINES,
                fix="add 'line: [[x, y], [x, y]]' or 'rectangle: [x_min, y_min, x_max, y_max]'",
            )
        else:
            yield error(
                "conflicting-keys",
                (*path, given[1]),
                f"{' and '.join(map(repr, given))} exclude each other: each says where the zone is",
                fix="keep one of them, or write one zone for each",
            )


def _outline(path: Path, zone: Zone) -> Iterator[Finding]:
    """Lines without length, and areas of size zero."""
    if zone.line is not None and zone.line[0] == zone.line[1]:
        message = "a line must have two different points"
        yield error("too-few-vertices", (*path, "line"), message, given=zone.line)
    if zone.rectangle is not None:
        yield from check_rectangle((*path, "rectangle"), zone.rectangle)
    if zone.polygon is not None:
        yield from check_polygon((*path, "polygon"), zone.polygon)


def _outside(context: Context, path: Path, zone: Zone) -> Iterator[Finding]:
    """Zones that lie entirely outside the world."""
    x0, y0, x1, y1 = context.scenario.world.bounds
    low_x, low_y, high_x, high_y = zone.bounds
    if low_x > x1 or high_x < x0 or low_y > y1 or high_y < y0:
        yield warning(
            "zone-outside-world",
            path,
            f"zone '{zone.name}' lies outside the world, which extends over x {x0:g} to {x1:g}, y {y0:g} to {y1:g}",
            fix="check its numbers: they are world coordinates in metres",
        )
