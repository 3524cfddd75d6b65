"""Centroid and radius of gyration of a compound, which contacts need."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

import irsim._core as core

__all__ = ["compound_body"]

_SEGMENTS_PER_QUARTER = 16
"""Number of segments that stand for a quarter circle."""


def compound_body(parts: Sequence[Any]) -> list[float]:
    """Return centroid and squared radius of gyration of the area that the parts of a compound cover together.

    Returns:
        x, y of the centroid [m, body frame]; if the area is in one piece, also the square of its radius of gyration
        [m^2], where holes count as filled. An empty list if a part is random, because its shape changes with each
        scene.
    """
    import shapely

    shapes: list[Any] = []
    for part in parts:
        if isinstance(part, core.Circle):
            shapes.append(shapely.Point(part.center).buffer(part.radius, quad_segs=_SEGMENTS_PER_QUARTER))
        elif isinstance(part, core.Polygon):
            shapes.append(shapely.Polygon(part.vertices))
        elif isinstance(part, core.Linestring):
            shapes.append(shapely.LineString(part.vertices))
        else:
            return []
    area: Any = shapely.union_all(shapes)
    centre = [area.centroid.x, area.centroid.y]
    return [*centre, _gyration2(area.exterior.coords, centre)] if area.geom_type == "Polygon" else centre


def _gyration2(ring: Any, centre: Sequence[float]) -> float:
    """Return the second moment of the area inside a closed ring about ``centre``, divided by the area [m^2]."""
    a = np.asarray(ring, dtype=np.float64)[:-1] - centre
    b = np.roll(a, -1, axis=0)
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return float(np.sum(cross * np.sum(a * a + a * b + b * b, axis=1)) / (6.0 * np.sum(cross)))
