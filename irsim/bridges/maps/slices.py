"""The parts of solids that a robot can meet: the outline of the part of a solid between two heights."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from irsim.bridges.maps.grid import Triangles, clipped
from irsim.common.arrays import Floats

__all__ = [
    "SEGMENTS",
    "box_points",
    "capsule_points",
    "cylinder_points",
    "ellipsoid_points",
    "moved",
    "slice_of_hull",
    "slice_of_mesh",
    "slice_of_prisms",
]

SEGMENTS = 64
"""Corners of round outlines."""
_RINGS = 16
"""Rings of corners of a ball between its middle and its top."""
_TINY = 1e-9
_UPRIGHT = 1e-6
"""Sine of the angle by which sides of prisms may lean, and share by which their ends may differ."""
_GRID = 1e-6
"""Distance of points that count as one, such as corners of neighbors that were rounded [m]."""
_SHEET = 0.01
"""Half of the thickness that a surface without an inside gets [m]."""


def box_points(size: Floats) -> Floats:
    """(8, 3) corners of a box around the origin, by its sides (3,)."""
    signs = np.array([[k & 1, k >> 1 & 1, k >> 2] for k in range(8)]) - 0.5
    points: Floats = signs * size
    return points


def _round(radius: float) -> Floats:
    """(SEGMENTS, 2) corners of a polygon with the area of a disk."""
    angle = (np.arange(SEGMENTS) + 0.5) * (2 * math.pi / SEGMENTS)
    wide = radius * math.sqrt(2 * math.pi / SEGMENTS / math.sin(2 * math.pi / SEGMENTS))
    return wide * np.column_stack([np.cos(angle), np.sin(angle)])


def cylinder_points(radius: float, length: float, top: float | None = None) -> Floats:
    """(2 * SEGMENTS, 3) corners of a cylinder along z around the origin; ``top`` is the radius of the upper end."""
    ends = ((radius, -length / 2), (radius if top is None else top, length / 2))
    return np.concatenate([np.column_stack([_round(r), np.full(SEGMENTS, z)]) for r, z in ends])


def capsule_points(radius: float, length: float) -> Floats:
    """Corners of a cylinder along z with half a ball at each end."""
    ball, half = ellipsoid_points(np.full(3, radius)), np.array([0, 0, length / 2])
    middle = _RINGS * SEGMENTS
    return np.concatenate([ball[: middle + SEGMENTS] - half, ball[middle:] + half])


def ellipsoid_points(radii: Floats) -> Floats:
    """(N, 3) corners of an ellipsoid around the origin, by its radii (3,)."""
    tilt = np.arange(-_RINGS, _RINGS + 1) * (math.pi / 2 / _RINGS)
    ring = _round(1.0)
    parts = [np.column_stack([ring * math.cos(a), np.full(SEGMENTS, math.sin(a))]) for a in tilt]
    points: Floats = np.concatenate(parts) * radii
    return points


def moved(place: Floats, points: Floats) -> Floats:
    """(N, 3) points of a frame whose place in the world is a (4, 4) matrix, in the world."""
    result: Floats = points @ place[:3, :3].T + place[:3, 3]
    return result


def slice_of_hull(points: Floats, low: float, high: float, *, rings: bool = False) -> Any:
    """The convex outline of the part of a convex solid between two heights; None if no part is there.

    Args:
        points: (N, 3) corners of the solid.
        low: The lower height [m].
        high: The upper height [m].
        rings: Whether the corners are rings of ``SEGMENTS`` corners, of which each is joined to the next one only.
    """
    z = points[:, 2]
    if z.max() <= low + _TINY or z.min() >= high - _TINY:
        return None
    kept = [points[(z >= low) & (z <= high), :2]]
    for limit in (low, high):
        if rings:
            ring = points.reshape(-1, SEGMENTS, 3)
            start, end = (
                np.concatenate([one.reshape(-1, 3), other])
                for one, other in ((ring[:-1], points), (ring[1:], np.roll(ring, -1, axis=1).reshape(-1, 3)))
            )
            crossing = (start[:, 2] < limit) != (end[:, 2] < limit)
            start, end = start[crossing], end[crossing]
        else:
            below, above = points[z < limit], points[z > limit]
            start, end = np.repeat(below, len(above), axis=0), np.tile(above, (len(below), 1))
        share = (limit - start[:, 2:]) / (end[:, 2:] - start[:, 2:])
        kept.append(start[:, :2] + share * (end[:, :2] - start[:, :2]))
    hull = shapely.convex_hull(shapely.MultiPoint(np.concatenate(kept)))
    return hull if hull.geom_type == "Polygon" and hull.area > _TINY else None


def slice_of_mesh(triangles: Triangles, low: float, high: float) -> Any:
    """The outline of the part of a mesh between two heights; None if no part is there.

    It is the cut at the lower height and, from there on, whatever surface there is above it. Surfaces without an inside
    count as thin walls.

    Args:
        triangles: (T, 3, 3) corners [m].
        low: The lower height [m].
        high: The upper height [m].
    """
    corners = np.asarray(triangles, dtype=np.float64)
    z = corners[..., 2]
    corners = corners[(z.max(axis=1) >= low) & (z.min(axis=1) <= high)]
    if not len(corners):
        return None
    parts = []
    bottom = float(corners[..., 2].min())
    ends = _cut(corners, max(low, bottom + 1e-6 * max(high - bottom, 1e-3)))
    if len(ends):
        lines = shapely.union_all(shapely.set_precision(shapely.linestrings(ends), _GRID))
        inside = _inside(lines, ends)
        loose = lines.difference(inside.buffer(1e-5)) if not inside.is_empty else lines
        parts += [inside, loose.buffer(_SHEET)] if loose.length > 0.05 * lines.length else [inside]
    between = clipped(corners[..., [2, 0, 1]], (low, -math.inf, high, math.inf))
    flat = shapely.get_parts(shapely.polygons(between[..., 1:]) if len(between) else np.array([], dtype=object))
    parts += [one for one in flat if one.area > _TINY]
    region = shapely.union_all(shapely.make_valid(np.array(parts, dtype=object))) if parts else None
    areas = [one for one in shapely.get_parts(region) if one.geom_type == "Polygon"] if region is not None else []
    return shapely.union_all(areas) if areas and sum(one.area for one in areas) > _TINY else None


def slice_of_prisms(triangles: Triangles, low: float, high: float) -> tuple[bool, Any]:
    """The outline of upright prisms between two heights, of any number of them in seconds.

    Args:
        triangles: (T, 3, 3) corners [m], counterclockwise seen from outside.
        low: The lower height [m].
        high: The upper height [m].

    Returns:
        Whether the surfaces are closed prisms that all begin and end at the same heights, and their outline; None if no
        part is between the heights.
    """
    corners = np.asarray(triangles, dtype=np.float64)
    sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    level, area = sides[:, 2], np.linalg.norm(sides, axis=1)
    z = corners[..., 2]
    bottom, top = float(z.min()), float(z.max())
    flat = np.abs(level) > _UPRIGHT * area
    ends = np.where(level < 0, bottom, top)
    as_prisms = np.abs(z - ends[:, None]).max(axis=1)[flat].max(initial=0.0) <= _UPRIGHT * max(top - bottom, 1.0)
    ground, roof = -level[flat & (level < 0)].sum(), level[flat & (level > 0)].sum()
    if not as_prisms or not ground > 0 or abs(ground - roof) > _UPRIGHT * ground:
        return False, None
    if bottom >= high - _TINY or top <= low + _TINY:
        return True, None
    grounds = shapely.polygons(corners[flat & (level < 0)][..., :2])
    return True, shapely.union_all(grounds)


def _inside(lines: Any, ends: Floats) -> Any:
    """The area inside of surfaces that are cut, also of surfaces that overlap.

    A face between the lines is inside if the surfaces run around it, or if an odd number of them is on one side of it,
    as where some look inwards by mistake. If each surface is there twice, once for each side, it counts once.

    Args:
        lines: The cuts as lines that cross only at their ends.
        ends: (S, 2, 2) the same lines, with the inside on their left.
    """
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(lines)))
    if not len(faces):
        return shapely.Polygon()
    points = shapely.get_coordinates(shapely.point_on_surface(faces))
    far = np.column_stack([np.full(len(points), ends[..., 0].max() + 1), points[:, 1]])
    which, line = shapely.STRtree(np.array(shapely.linestrings(ends), dtype=object)).query(
        shapely.linestrings(np.stack([points, far], axis=1))
    )
    (x, y), (start, end) = points[which].T, ends[line].transpose(1, 0, 2)
    rises = end[:, 1] - start[:, 1]
    crossed = (start[:, 1] <= y) != (end[:, 1] <= y)
    share = (y - start[:, 1]) / np.where(crossed, rises, 1.0)
    crossed &= start[:, 0] + share * (end[:, 0] - start[:, 0]) > x
    around = np.bincount(which[crossed], np.sign(rises[crossed]), minlength=len(faces))
    once = _first(ends)
    counted = crossed & (once[line] if 2 * once.sum() == len(once) else True)
    odd = np.bincount(which[counted], minlength=len(faces)) % 2 == 1
    return shapely.union_all(faces[(around != 0) | odd])


def _first(ends: Floats) -> NDArray[np.bool_]:
    """Which lines are the first ones between their ends, in any direction."""
    rounded = np.sort(np.round(ends * 1e6).view(np.complex128)[..., 0], axis=1)
    result = np.zeros(len(ends), bool)
    result[np.unique(rounded, axis=0, return_index=True)[1]] = True
    return result


def _cut(corners: Floats, height: float) -> Floats:
    """(S, 2, 2) lines in which triangles cross a height; surfaces that look outwards have their inside on the left."""
    above = corners[..., 2] > height
    crossing = corners[above.any(axis=1) & ~above.all(axis=1)]
    above = crossing[..., 2] > height
    single = np.where((above.sum(axis=1) == 1)[:, None], above, ~above)
    order = (np.argmax(single, axis=1)[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(crossing, order[..., None], axis=1).transpose(1, 0, 2)
    ends = [a + (other - a) * ((height - a[:, 2]) / (other[:, 2] - a[:, 2]))[:, None] for other in (b, c)]
    lines = np.stack(ends, axis=1)[..., :2]
    lines = np.where((above.sum(axis=1) == 1)[:, None, None], lines, lines[:, ::-1])
    long: Floats = lines[np.hypot(*(lines[:, 0] - lines[:, 1]).T) > _TINY]
    return long
