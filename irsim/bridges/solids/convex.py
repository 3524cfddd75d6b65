"""Polygons that are not convex, as a few convex pieces: triangles, merged while they stay convex."""

from __future__ import annotations

import numpy as np

from irsim.common.arrays import Floats

__all__ = ["convex_pieces", "is_convex", "triangles"]

_SMALLEST_AREA = 1e-10
"""Smaller triangles are left out [m²]: solvers of contacts fail with them."""
_STRAIGHT = 1e-9
"""Sine of the turn at a corner, below which it counts as straight."""


def is_convex(corners: Floats) -> bool:
    """Whether a counterclockwise polygon (K, 2) turns left, or goes straight on, at each corner."""
    before, after = corners - np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0) - corners
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    scale = np.hypot(*before.T) * np.hypot(*after.T)
    if not (cross >= -_STRAIGHT * scale).all():
        return False
    turned = np.arctan2(cross, (before * after).sum(axis=1)).sum()
    return bool(abs(turned - 2 * np.pi) < 1e-3)  # a star turns left at each corner, too, but more than once round


def triangles(corners: Floats) -> Floats:
    """(K, 3, 2) counterclockwise triangles that fill a simple polygon (N, 2), with its corners only."""
    import shapely

    region = shapely.Polygon(corners)
    if not region.is_valid:
        region = region.buffer(0)
    found = []
    for triangle in shapely.get_parts(shapely.constrained_delaunay_triangles(region)):
        points = shapely.get_coordinates(triangle)[:3]
        a, b = points[1] - points[0], points[2] - points[0]
        area = float(a[0] * b[1] - a[1] * b[0]) / 2
        if abs(area) > _SMALLEST_AREA:
            found.append(points if area > 0 else points[::-1])
    return np.array(found).reshape(-1, 3, 2)


def convex_pieces(corners: Floats) -> list[Floats]:
    """Convex counterclockwise polygons that fill a simple polygon and touch only at their edges (Hertel, Mehlhorn).

    Args:
        corners: (K, 2) of the polygon, convex or not.
    """
    parts = triangles(corners)
    points, index = np.unique(parts.reshape(-1, 2), axis=0, return_inverse=True)
    pieces: dict[int, list[int]] = dict(enumerate(index.reshape(-1, 3).tolist()))
    owner: dict[tuple[int, int], int] = {}
    for key, piece in pieces.items():
        owner.update(dict.fromkeys(_edges(piece), key))
    for a, b in list(owner):
        one, other = owner.get((a, b)), owner.get((b, a))
        if one is None or other is None or one == other:
            continue
        merged = _merged(pieces[one], pieces[other], a, b)
        if not is_convex(points[merged]):
            continue
        del owner[a, b], owner[b, a]
        owner.update(dict.fromkeys(_edges(merged), one))
        pieces[one] = merged
        del pieces[other]
    return [points[piece] for piece in pieces.values()]


def _edges(piece: list[int]) -> list[tuple[int, int]]:
    return list(zip(piece, [*piece[1:], piece[0]], strict=True))


def _merged(one: list[int], other: list[int], a: int, b: int) -> list[int]:
    """Corners of two pieces together, of which one has the edge from a to b and the other has it from b to a."""
    k, m = one.index(b), other.index(a)
    first = one[k:] + one[:k]  # from b to a
    second = other[m:] + other[:m]  # from a to b
    return first + second[1:-1]
