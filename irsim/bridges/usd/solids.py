"""Closed solids of footprints, walls and maps, as arrays, and names of prims; nothing of OpenUSD is needed here."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from irsim.bridges.solids import merged_cells
from irsim.common.arrays import Floats
from irsim.common.outline import Circle, Line, Polygon, triangles_of
from irsim.simulation.scene import Grid

__all__ = [
    "WALL_THICKNESS",
    "Solid",
    "arrow",
    "disc_solid",
    "grid_solid",
    "line_solid",
    "plane",
    "polygon_solid",
    "prim_names",
]

WALL_THICKNESS = 0.05
"""Thickness of solids of lines, which are infinitely thin in the plane [m]."""
_DISC_CORNERS = 48
_CONVEX = 1e-9
"""Share of its area by which the convex hull of a convex region may be larger, because of rounding."""
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Solid:
    """A closed surface whose faces run counterclockwise seen from outside.

    Attributes:
        points: (P, 3) corners [m].
        counts: (F,) corners of each face.
        indices: (sum of counts,) corners of the faces, one after the other.
        convex: Whether it is convex.
    """

    points: Floats
    counts: Ints
    indices: Ints
    convex: bool

    @property
    def normals(self) -> Floats:
        """(sum of counts, 3) unit normal of the face of each corner, outwards."""
        first = np.concatenate([[0], np.cumsum(self.counts)[:-1]]).astype(np.int64)
        a, b, c = (self.points[self.indices[first + k]] for k in range(3))
        normal = np.cross(b - a, c - a)
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        unit: Floats = np.repeat(normal / np.where(length > 0, length, 1.0), self.counts, axis=0)
        return unit


def polygon_solid(polygon: Polygon, height: float) -> Solid | None:
    """The prism of a polygon, from the ground up; None if it has no area."""
    region: BaseGeometry = shapely.Polygon(polygon.corners)
    if not region.is_valid:
        region = shapely.make_valid(region)
    return _prism(region, height)


def disc_solid(circle: Circle, height: float) -> Solid:
    """A prism whose corners are on a circle, from the ground up."""
    angle = np.linspace(0.0, 2 * np.pi, _DISC_CORNERS, endpoint=False)
    corners = np.array(circle.center) + circle.radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return _convex_prism(corners, height)


def line_solid(line: Line, height: float, thickness: float = WALL_THICKNESS) -> Solid | None:
    """One box for each leg of a line, as long as to meet the next one; None for a line without length.

    Args:
        line: The line.
        height: [m].
        thickness: [m].
    """
    points = line.path
    legs = np.diff(points, axis=0)
    length = np.hypot(*legs.T)
    kept = length > 0
    if not kept.any():
        return None
    along = legs[kept] / length[kept, None] * (thickness / 2)
    aside = np.stack([-along[:, 1], along[:, 0]], axis=1)
    start, end = points[:-1][kept] - along, points[1:][kept] + along
    quads = np.stack([start - aside, end - aside, end + aside, start + aside], axis=1)
    return _boxes(quads, height)


def grid_solid(grid: Grid, height: float) -> Solid | None:
    """Boxes over the solid cells of a map, as few as runs along x that repeat along y allow; None without any."""
    result = merged_cells(grid)
    if not len(result):
        return None
    x0, y0, x1, y1 = result.T
    corners = [np.stack(pair, axis=1) for pair in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]
    return _boxes(np.stack(corners, axis=1), height)


def plane(low: tuple[float, float], high: tuple[float, float]) -> Solid:
    """The ground: one rectangle that looks up, and is not closed."""
    points = np.array([[low[0], low[1], 0], [high[0], low[1], 0], [high[0], high[1], 0], [low[0], high[1], 0]])
    return Solid(points.astype(np.float64), np.array([4]), np.arange(4), True)


def arrow(radius: float, low: float, high: float) -> Solid:
    """A flat wedge that shows where a body of this radius [m] looks, between two heights [m]."""
    corners = np.array([[0.9, 0.0], [0.35, 0.35], [0.35, -0.35]]) * radius
    result = polygon_solid(Polygon(corners), high - low)
    assert result is not None
    return replace(result, points=result.points + np.array([0.0, 0.0, low]))


def _boxes(quads: Floats, height: float) -> Solid:
    """Boxes over (B, 4, 2) quadrilaterals whose corners run counterclockwise."""
    count = len(quads)
    points = np.zeros((count, 2, 4, 3))
    points[..., :2] = quads[:, None]
    points[:, 1, :, 2] = height
    sides = [[k, (k + 1) % 4, (k + 1) % 4 + 4, k + 4] for k in range(4)]
    faces = np.array([[3, 2, 1, 0], [4, 5, 6, 7], *sides], dtype=np.int64)
    indices = (faces[None] + 8 * np.arange(count)[:, None, None]).reshape(-1)
    return Solid(points.reshape(-1, 3), np.full(6 * count, 4, dtype=np.int64), indices, count == 1)


def _prism(region: BaseGeometry, height: float) -> Solid | None:
    """A region of the plane, extruded upwards; triangles at both ends and quadrilaterals at the sides."""
    areas = [shapely.orient_polygons(part) for part in shapely.get_parts(region) if part.geom_type == "Polygon"]
    areas = [area for area in areas if area.area > 0]
    if not areas:
        return None
    if len(areas) == 1 and not areas[0].interiors and _is_convex(areas[0]):
        return _convex_prism(shapely.get_coordinates(areas[0].exterior)[:-1], height)
    corners: dict[tuple[float, float], int] = {}
    sides: list[tuple[int, int]] = []
    triangles: list[list[int]] = []
    for area in areas:
        for ring in (area.exterior, *area.interiors):
            numbers = [corners.setdefault(point, len(corners)) for point in ring.coords]
            sides += itertools.pairwise(numbers)
        triangles += [[corners[x, y] for x, y in triangle] for triangle in triangles_of(area).tolist()]
    count = len(corners)
    flat = np.array(list(corners), dtype=np.float64)
    top, around = np.array(triangles, dtype=np.int64) + count, np.array(sides, dtype=np.int64)
    quads = np.stack([around[:, 0], around[:, 1], around[:, 1] + count, around[:, 0] + count], axis=1)
    return Solid(
        points=_doubled(flat, height),
        counts=np.repeat([3, 3, 4], [len(top), len(top), len(quads)]),
        indices=np.concatenate([(top - count)[:, ::-1].ravel(), top.ravel(), quads.ravel()]),
        convex=False,
    )


def _convex_prism(corners: Floats, height: float) -> Solid:
    """A prism whose ends are one face each; the corners run counterclockwise."""
    count = len(corners)
    low = np.arange(count)
    after = np.roll(low, -1)
    quads = np.stack([low, after, after + count, low + count], axis=1)
    return Solid(
        points=_doubled(corners, height),
        counts=np.concatenate([[count, count], np.full(count, 4)]),
        indices=np.concatenate([low[::-1], low + count, quads.ravel()]),
        convex=True,
    )


def _doubled(corners: Floats, height: float) -> Floats:
    """(2 K, 3) corners on the ground, then the same at a height."""
    points = np.zeros((2, len(corners), 3))
    points[:, :, :2] = corners
    points[1, :, 2] = height
    return points.reshape(-1, 3)


def _is_convex(area: Any) -> bool:
    return bool(area.convex_hull.area - area.area <= _CONVEX * area.area)


_LONGEST = 100


def prim_names(names: Iterable[str]) -> list[str]:
    """A valid name for each name, all different: ``robot 1`` becomes ``robot_1``, a second one ``robot_1_2``."""
    taken: set[str] = set()
    result = []
    for name in names:
        plain = re.sub(r"[^A-Za-z0-9_]", "_", name)[:_LONGEST] or "object"
        plain = f"_{plain}" if plain[0].isdigit() else plain
        chosen, number = plain, 2
        while chosen.lower() in taken:
            chosen, number = f"{plain}_{number}", number + 1
        taken.add(chosen.lower())
        result.append(chosen)
    return result
