"""Outlines as obstacles of a scenario: disks stay circles, boxes rectangles, and everything else is polygons."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import shapely

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.source import Outlined
from irsim.common.arrays import Floats
from irsim.common.text import clean, decimal, plural
from irsim.options.units import MAX_VERTICES

__all__ = ["entries_of"]

_MAX_OBSTACLES = 5000
_SMALLEST = 1e-4
"""Smallest area of an obstacle [m²]."""
_EXACT = 5e-4
"""Distance by which outlines may become simpler [m]."""
_DIGITS = 4
"""Digits of lengths behind the point."""
_LEAST_CORNERS = 12
"""Corners of a regular polygon that is a disk."""
_SAME = 1e-6
"""Share of an outline that may be outside of another one which covers it."""
_TINY = 1e-3
"""Share by which circles and rectangles may differ from what a file has."""


def entries_of(things: list[Outlined]) -> tuple[list[str], list[str]]:
    """Lines of YAML, one for each obstacle, and remarks on what was left out or cut.

    Args:
        things: The outlines that stand in the way.

    Raises:
        BridgeError: There would be too many obstacles.
    """
    lines: list[str] = []
    small = cut = 0
    kept = _outermost(things)
    for thing in kept:
        parts = [part for part in shapely.get_parts(thing.region) if part.geom_type == "Polygon"]
        for part in parts:
            if part.area < _SMALLEST:
                small += 1
                continue
            pieces = _without_holes(part)
            cut += len(pieces) > 1
            circle = thing.circle if len(parts) == 1 else None
            lines += [_entry(piece, circle, thing.name) for piece in pieces if piece.area >= _SMALLEST]
            if len(lines) > _MAX_OBSTACLES:
                what = f"the scene would have more than {_MAX_OBSTACLES:,} obstacles"
                raise BridgeError("bridge-file", what, "take a part of it with --bounds, or leave out --obstacles")
    notes = []
    if len(kept) < len(things):
        count = len(things) - len(kept)
        notes.append(f"left out: {plural(count, 'outline')} within another one, which stands there as well")
    if small:
        notes.append(f"left out: {plural(small, 'outline')} smaller than {_SMALLEST * 1e4:g} cm²")
    if cut:
        notes.append(f"cut into pieces, as obstacles have no holes: {plural(cut, 'outline')}")
    return lines, notes


def _outermost(things: list[Outlined]) -> list[Outlined]:
    """The things that no other one covers, such as one of several boards of a shelf."""
    regions = np.array([thing.region for thing in things], dtype=object)
    inner, outer = shapely.STRtree(regions).query(regions, predicate="intersects")
    inner, outer = inner[inner != outer], outer[inner != outer]
    areas = shapely.area(regions)
    larger = (areas[outer] > areas[inner]) | ((areas[outer] == areas[inner]) & (outer < inner))
    inner, outer = inner[larger], outer[larger]
    shared = shapely.area(shapely.intersection(regions[inner], regions[outer]))
    covered = set(inner[shared >= (1 - _SAME) * areas[inner]].tolist())
    return [thing for number, thing in enumerate(things) if number not in covered]


def _entry(region: Any, circle: tuple[float, float, float] | None, name: str) -> str:
    """An obstacle as a line of YAML."""
    disk = circle or _disk(region)
    box = None if disk is not None else _box(region)
    if disk is not None:
        x, y, heading = disk[0], disk[1], 0.0
        shape = f"name: circle, radius: {decimal(disk[2], _DIGITS)}"
    elif box is not None:
        x, y, heading, length, width = box
        shape = f"name: rectangle, length: {decimal(length, _DIGITS)}, width: {decimal(width, _DIGITS)}"
    else:
        corners = _corners(region)
        x, y = corners.mean(axis=0).round(3).tolist()
        heading = 0.0
        listed = ", ".join(f"[{decimal(a - x, _DIGITS)}, {decimal(b - y, _DIGITS)}]" for a, b in corners)
        shape = f"name: polygon, vertices: [{listed}]"
    comment = f"  # {clean(name, 60)}" if name else ""
    state = ", ".join(decimal(value, _DIGITS) for value in (x, y, heading))
    return f"  - {{shape: {{{shape}}}, state: [{state}]}}{comment}"


def _disk(region: Any) -> tuple[float, float, float] | None:
    """Center and radius of a regular polygon of many corners, which stands for a disk of its area."""
    ring = np.unique(shapely.get_coordinates(region.exterior)[:-1].round(9), axis=0)
    if len(ring) < _LEAST_CORNERS:
        return None
    middle = np.array(region.centroid.coords[0])
    away = np.hypot(*(ring - middle).T)
    angles = np.sort(np.arctan2(*(ring - middle).T))
    gaps = np.diff(angles, append=angles[0] + 2 * math.pi)
    if np.ptp(away) > _TINY * away.mean() or gaps.max() > 1.5 * 2 * math.pi / _LEAST_CORNERS:
        return None
    return float(middle[0]), float(middle[1]), math.sqrt(region.area / math.pi)


def _box(region: Any) -> tuple[float, float, float, float, float] | None:
    """Center, heading, length and width of a rectangle."""
    around = region.minimum_rotated_rectangle
    if around.geom_type != "Polygon" or around.area - region.area > _TINY * around.area:
        return None
    a, b, c = shapely.get_coordinates(around)[:3]
    sides = float(np.hypot(*(b - a))), float(np.hypot(*(c - b)))
    along = b - a if sides[0] >= sides[1] else c - b
    heading = math.atan2(along[1], along[0])
    heading -= math.pi * round(heading / math.pi)  # half a turn changes nothing
    x, y = (a + c) / 2
    return float(x), float(y), heading, max(sides), min(sides)


def _corners(region: Any) -> Floats:
    """(K, 2) corners of a polygon without holes, few enough for a shape."""
    tolerance = min(_EXACT, 5e-3 * math.sqrt(region.area))
    simple = region
    while True:
        simpler = region.simplify(tolerance)
        if simpler.geom_type == "Polygon" and simpler.is_valid and not simpler.interiors and simpler.area > 0:
            simple = simpler
        if len(simple.exterior.coords) <= MAX_VERTICES:
            break
        tolerance *= 2
    corners: Floats = shapely.get_coordinates(simple.exterior)[:-1]
    return corners


def _without_holes(region: Any) -> list[Any]:
    """Pieces of a polygon that have no holes, cut through holes in the middle of the others."""
    if not region.interiors:
        return [region]
    left, lower, right, upper = region.bounds
    across = 0 if right - left >= upper - lower else 1
    middles = sorted(hole.centroid.coords[0][across] for hole in region.interiors)
    middle = middles[len(middles) // 2]
    if across == 0:
        halves = (
            shapely.box(left - 1, lower - 1, middle, upper + 1),
            shapely.box(middle, lower - 1, right + 1, upper + 1),
        )
    else:
        halves = (
            shapely.box(left - 1, lower - 1, right + 1, middle),
            shapely.box(left - 1, middle, right + 1, upper + 1),
        )
    parts = [part for half in halves for part in shapely.get_parts(region.intersection(half))]
    return [piece for part in parts if part.geom_type == "Polygon" for piece in _without_holes(part)]
