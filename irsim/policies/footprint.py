"""The footprints of robots, as policies learn them."""

from __future__ import annotations

import numpy as np
import shapely

import irsim._core as core
from irsim.common.arrays import Floats

__all__ = ["footprint"]

_CORNERS = 16
"""Number of corners of the polygon around a circle."""


def footprint(state: core.State, row: int) -> Floats:
    """(K, 2) corners of the convex hull of a body, counterclockwise, body frame [m]; see :class:`Episode`."""
    points: list[Floats] = []
    for part, kind in enumerate(state.parts(row)):
        if kind == "circle":
            x, y, radius = state.circle(row, part, False)
            angle = (np.arange(_CORNERS) + 0.5) * (2 * np.pi / _CORNERS)
            around = radius / np.cos(np.pi / _CORNERS)
            points.append(np.column_stack([x + around * np.cos(angle), y + around * np.sin(angle)]))
        elif kind != "cells":
            points.append(np.asarray(state.vertices(row, part, False), dtype=np.float64)[:, :2])
    hull = shapely.convex_hull(shapely.MultiPoint(np.concatenate(points)))
    corners = shapely.get_coordinates(shapely.orient_polygons(hull)) if hull.geom_type == "Polygon" else None
    found: Floats = shapely.get_coordinates(hull) if corners is None else corners[:-1]
    return found
