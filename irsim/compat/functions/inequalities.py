"""Convex polygons as inequalities, for convex optimisation."""

from __future__ import annotations

import numpy as np

from irsim.common.arrays import Floats

__all__ = ["polygon_inequality"]


def polygon_inequality(points: Floats, straight: float = 0.0) -> tuple[Floats, Floats] | None:
    """Write a convex polygon as ``G p <= h``.

    Args:
        points: (M, 2) vertices in either direction [m].
        straight: A corner that turns less than this counts as straight [m2].

    Returns:
        G: (M, 2) outward normals of the edges, not normalised. h: (M, 1). None if the polygon is not convex.
    """
    edges = np.roll(points, -1, axis=0) - points
    ahead = np.roll(edges, -1, axis=0)
    turns = edges[:, 0] * ahead[:, 1] - edges[:, 1] * ahead[:, 0]
    if (turns < -straight).any() and (turns > straight).any():
        return None
    if turns.sum() < 0:
        points = points[::-1]
        edges = np.roll(points, -1, axis=0) - points
    normals = np.column_stack([edges[:, 1], -edges[:, 0]])
    return normals, (normals * points).sum(axis=1, keepdims=True)
