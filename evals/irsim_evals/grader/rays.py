"""Straight looks through a world: how far it is to the next solid thing."""

from __future__ import annotations

import math
from typing import Any

import shapely
import shapely.affinity

__all__ = ["Point", "along", "free_length", "free_parts"]

Point = tuple[float, float]
_SLIVER = 1e-6
"""Free parts shorter than this [m] come from rounding."""


def along(start: Point, direction: float, distance: float) -> Point:
    """The point at a distance [m] in a direction [rad]."""
    return start[0] + math.cos(direction) * distance, start[1] + math.sin(direction) * distance


def free_length(solid: Any, start: Point, direction: float, most: float) -> float:
    """Distance [m] from a point to the first solid thing in a direction, at most ``most``; 0 inside of one."""
    hit = shapely.intersection(solid, shapely.LineString([start, along(start, direction, most)]))
    return most if hit.is_empty else float(shapely.distance(shapely.Point(start), hit))


def free_parts(solid: Any, start: Point, end: Point, depth: float) -> list[tuple[float, float]]:
    """The parts of a line that nothing solid crosses.

    Args:
        solid: Geometry of everything solid.
        start, end: Ends of the line.
        depth: Whatever lies at most this far beside the line counts as on it [m], so that the two jambs of a door
            need not be exactly in line.

    Returns:
        Begin and end of each free part, as distances from ``start`` [m].
    """
    length = math.dist(start, end)
    heading = math.atan2(end[1] - start[1], end[0] - start[0])
    line = shapely.LineString([start, end])
    near = shapely.intersection(solid, line.buffer(max(depth, 1e-9), cap_style="flat"))
    turned = shapely.affinity.rotate(near, -heading, origin=start, use_radians=True)
    covered = sorted(
        (part.bounds[0] - start[0], part.bounds[2] - start[0])
        for part in getattr(turned, "geoms", [turned])
        if not part.is_empty
    )
    free, at = [], 0.0
    for low, high in covered:
        if low - at > _SLIVER:
            free.append((at, low))
        at = max(at, high)
    if length - at > _SLIVER:
        free.append((at, length))
    return free
