"""Polygon helpers, with the function names of IR-SIM 2.12."""

from __future__ import annotations

from typing import Any

import numpy as np
from shapely.affinity import affine_transform

from irsim.common.arrays import Floats
from irsim.compat.functions.frames import get_affine_transform
from irsim.compat.functions.polygons import polygon_inequality
from irsim.compat.util.random import rng

__all__ = [
    "cross_product",
    "gen_inequal_from_vertex",
    "geometry_transform",
    "is_convex_and_ordered",
    "is_convex_polygon",
    "random_point_range",
]

_MIN_CORNERS = 3


def cross_product(o: Any, a: Any, b: Any) -> float:
    """Return the cross product of the vectors o -> a and o -> b; it is positive if b lies to the left of o -> a."""
    result: float = (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])
    return result


def is_convex_and_ordered(points: Any) -> tuple[bool, str | None]:
    """Return whether (2, N) points are the corners of a convex polygon, and their order: ``CW``, ``CCW`` or None.

    Corners on the line between their neighbours change nothing.
    """
    corners = np.asarray(points, dtype=np.float64).T
    if len(corners) < _MIN_CORNERS:
        return False, None
    turns = [cross_product(corners[k - 2], corners[k - 1], corners[k]) for k in range(len(corners))]
    left, right = any(turn > 0 for turn in turns), any(turn < 0 for turn in turns)
    if left == right:
        return False, None
    return True, "CCW" if left else "CW"


def gen_inequal_from_vertex(vertex: Any) -> tuple[Floats | None, Floats | None]:
    """Return G and h of the inequality ``G p <= h`` that holds for the points of a convex polygon.

    Args:
        vertex: (2, N) corners in either order.

    Returns:
        G (N, 2), outward normals of any length, and h (N, 1); None and None if the polygon is not convex.
    """
    convex, _ = is_convex_and_ordered(vertex)
    inequality = polygon_inequality(np.asarray(vertex, dtype=np.float64).T) if convex else None
    return inequality or (None, None)


def geometry_transform(geometry: Any, state: Any) -> Any:
    """Transform a shapely geometry from the body frame to a pose; without a geometry, return None."""
    if geometry is None:
        return None
    return affine_transform(geometry, get_affine_transform(state))


def is_convex_polygon(polygon: Any, tolerance: float = 1e-9) -> bool:
    """Whether a shapely polygon is convex."""
    return bool(polygon.convex_hull.area - polygon.area <= tolerance)


def random_point_range(range_low: Any = None, range_high: Any = None) -> Floats:
    """Return a (3, 1) point drawn uniformly from a box, by default [0, 0, -pi] to [10, 10, pi]."""
    low = np.array([0.0, 0.0, -np.pi] if range_low is None else range_low, dtype=np.float64).reshape(-1, 1)
    high = np.array([10.0, 10.0, np.pi] if range_high is None else range_high, dtype=np.float64).reshape(-1, 1)
    point: Floats = rng.uniform(low, high)
    return point
