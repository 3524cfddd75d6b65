"""The area that the parts of a compound cover together, as contacts need it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

import irsim._core as core

__all__ = ["compound_body"]

_QUADRANT_SEGMENTS = 16
"""Segments in a quarter of a circle."""


def compound_body(parts: Sequence[Any]) -> list[float]:
    """What contacts need to know of the area that parts of a compound cover together.

    Returns:
        Its centre, x, y [m, body frame], and the square of its radius of gyration [m^2] if it is in one piece (holes
        count as filled); empty where a part is drawn per scene.
    """
    import shapely

    shapes: list[Any] = []
    for part in parts:
        if isinstance(part, core.Circle):
            shapes.append(shapely.Point(part.center).buffer(part.radius, quad_segs=_QUADRANT_SEGMENTS))
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
    """Second moment of the area in a closed ring about ``centre``, per area [m^2]."""
    a = np.asarray(ring, dtype=np.float64)[:-1] - centre
    b = np.roll(a, -1, axis=0)
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return float(np.sum(cross * np.sum(a * a + a * b + b * b, axis=1)) / (6.0 * np.sum(cross)))
