"""Checks ``world.zones``: names, one outline each, areas that enclose something, places outside the world, ground."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from irsim.diagnostics.diagnostic import Path
from irsim.options.registry import KINEMATICS
from irsim.scenario.checks._context import Context
from irsim.scenario.checks._outlines import check_polygon, check_rectangle
from irsim.scenario.messages.findings import Finding, error, hint, warning
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
            yield from _ground(context, path, zone)
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


def _ground(context: Context, path: Path, zone: Zone) -> Iterator[Finding]:
    """Ground of lines, and ground that no drive of the scenario, or not all of them, feel."""
    given = {"slip": zone.slip or zone.slip_std, "grip": zone.grip != 1.0, "surface": zone.surface}
    for key in [key for key, has_effect in given.items() if has_effect]:
        if zone.is_line:
            message = f"zone '{zone.name}' is a line, which has no ground"
            fix = "give it an area: 'rectangle', 'polygon' or 'circle'"
            yield error("conflicting-keys", (*path, key), message, given=getattr(zone, key), fix=fix)
            continue
        drives: list[Any] = [record.kinematics for record in context.entry_objects if not record.static]
        moving = [drive for drive in drives if drive is not None]
        unfelt = sorted({drive.name for drive in moving if key not in drive.feels})
        felt = any(key in drive.feels for drive in moving)
        if felt and key == "slip" and unfelt:
            names = ", ".join(map(repr, unfelt))
            message = f"the drives {names} do not slip: of drives in Python, irsim does not know the wheels"
            yield hint("ground-unfelt", (*path, key), message, fix="nothing to fix if they need not slip")
        elif moving and not felt:
            names = " and ".join(
                map(repr, sorted(one.name for one in KINEMATICS.features() if key in getattr(one.options, "feels", ())))
            )
            yield warning(
                "ground-unfelt",
                (*path, key),
                f"no drive of this scenario feels the '{key}' of zone '{zone.name}': only {names} do",
                given=getattr(zone, key),
                fix=f"use another drive, or remove '{key}'",
            )


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
