"""The outline of a body: its parts, the box and the hull around them, and the same for shapely and for the core."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

import irsim._core as core
from irsim.common.arrays import Floats

__all__ = [
    "BodyPart",
    "Cells",
    "Circle",
    "Line",
    "Outline",
    "Part",
    "Polygon",
    "outline",
    "part_of",
    "plain_outlines",
    "points_of",
    "triangles_of",
]

_HULL_CORNERS = 16
"""Number of corners of the polygon around a circle in a hull."""
_QUARTER_SEGMENTS = 16
"""Number of segments of a quarter circle in shapely's polygon of a circle, as in IR-SIM."""


@dataclass(frozen=True)
class Circle:
    """A disk.

    Attributes:
        center: (2,) [m].
        radius: [m].
    """

    center: tuple[float, float]
    radius: float


@dataclass(frozen=True)
class Polygon:
    """A simple polygon, convex or not.

    Attributes:
        corners: (K, 2) without a repeated first corner [m].
    """

    corners: Floats


@dataclass(frozen=True)
class Line:
    """A polyline without thickness, such as a wall.

    Attributes:
        points: (K, 2) [m].
        closed: Whether the last point is joined to the first one.
    """

    points: Floats
    closed: bool = False

    @property
    def path(self) -> Floats:
        """(N, 2) points along the line [m]; a closed one ends where it begins."""
        return np.concatenate([self.points, self.points[:1]]) if self.closed else self.points


@dataclass(frozen=True)
class Cells:
    """The occupied cells of a map.

    Attributes:
        grid: Occupancy of the core.
        points: (4, 2) corners of the box around the map [m].
    """

    grid: core.OccupancyGrid
    points: Floats


BodyPart: TypeAlias = Circle | Polygon | Line
"""A part of a body other than a map."""
Part: TypeAlias = BodyPart | Cells


@dataclass(frozen=True)
class Outline:
    """The area that a body occupies: the union of its parts, all in one frame.

    Attributes:
        parts: Its parts in the order of the shape.
    """

    parts: Sequence[Part]

    def box(self) -> tuple[Floats, Floats]:
        """Lower and upper corner of the bounding box, (2,) each [m]; infinite and reversed without parts."""
        low, high = np.full(2, math.inf), np.full(2, -math.inf)
        for part in self.parts:
            if isinstance(part, Circle):
                center, size = np.asarray(part.center), part.radius
                low, high = np.minimum(low, center - size), np.maximum(high, center + size)
            else:
                points = points_of(part)
                low, high = np.minimum(low, points.min(axis=0)), np.maximum(high, points.max(axis=0))
        return low, high

    def hull(self) -> Floats:
        """(K, 2) corners of the convex hull, counterclockwise [m].

        A regular polygon of 16 corners encloses each circle; maps are left out.
        """
        import shapely

        points = [_around(part) if isinstance(part, Circle) else points_of(part)
                  for part in self.parts if not isinstance(part, Cells)]  # fmt: skip
        hull = shapely.convex_hull(shapely.MultiPoint(np.concatenate(points)))
        is_area = hull.geom_type == "Polygon"
        corners: Floats = shapely.get_coordinates(shapely.orient_polygons(hull) if is_area else hull)
        return corners[:-1] if is_area else corners

    def shapely(self, quarter: int = _QUARTER_SEGMENTS) -> Any:
        """The only part as a shapely geometry, or the union of several.

        Args:
            quarter: Segments of a quarter circle: circles are polygons.
        """
        import shapely

        made = [_shapely_of(part, quarter) for part in self.parts]
        return made[0] if len(made) == 1 else shapely.union_all(made)

    def core(self) -> list[core.Part]:
        """The parts for queries of the core."""
        return [_core_of(part) for part in self.parts]


def outline(state: core.State, row: int, *, world_frame: bool = False) -> Outline:
    """The outline of the object in a row of the core's state.

    Args:
        state: State of the simulation.
        row: Row of the object.
        world_frame: At its present pose in the world frame; otherwise in the body frame. Maps are always in the world
            frame.
    """
    return Outline(tuple(_part(state, row, part, kind, world_frame) for part, kind in enumerate(state.parts(row))))


def plain_outlines(state: core.State, rows: int) -> list[list[dict[str, Any]]]:
    """The parts of the first objects of a state as plain data, body frame [m]; a map has the corners of its box."""
    return [[_plain(part) for part in outline(state, row).parts] for row in range(rows)]


def _plain(part: Part) -> dict[str, Any]:
    if isinstance(part, Circle):
        return {"kind": "circle", "center": part.center, "radius": part.radius}
    kind = "polygon" if isinstance(part, Polygon) else "cells"
    if isinstance(part, Line):
        kind = "room" if part.closed else "line"
    return {"kind": kind, "vertices": points_of(part).tolist()}


def points_of(part: Polygon | Line | Cells) -> Floats:
    """(K, 2) corners of a polygon or points of a line, or the corners of the box around a map [m]."""
    return part.corners if isinstance(part, Polygon) else part.points


def _part(state: core.State, row: int, part: int, kind: str, world_frame: bool) -> Part:
    if kind == "circle":
        x, y, radius = state.circle(row, part, world_frame)
        return Circle((x, y), radius)
    points = state.vertices(row, part, world_frame)
    if kind == "polygon":
        return Polygon(points)
    grid = state.cells(row) if kind == "cells" else None
    return Line(points, closed=kind == "room") if grid is None else Cells(grid, points)


def part_of(part: core.Part) -> BodyPart | None:
    """A part of the core; None for a map, and for a part that differs from scene to scene."""
    if isinstance(part, core.Circle):
        x, y = part.center
        return Circle((x, y), part.radius)
    if isinstance(part, core.Polygon):
        return Polygon(np.array(part.vertices))
    if isinstance(part, (core.Linestring, core.Room)):
        return Line(np.array(part.vertices), closed=isinstance(part, core.Room))
    return None


def triangles_of(region: Any) -> Floats:
    """(K, 3, 2) counterclockwise triangles that fill the areas of a shapely geometry, with its corners only."""
    import shapely

    areas = [part for part in shapely.get_parts(region) if part.geom_type == "Polygon"]
    parts = shapely.get_parts(shapely.constrained_delaunay_triangles(np.array(areas, dtype=object)))
    corners: Floats = shapely.get_coordinates(shapely.orient_polygons(parts)).reshape(-1, 4, 2)[:, :3]
    return corners


def _around(circle: Circle) -> Floats:
    angle = (np.arange(_HULL_CORNERS) + 0.5) * (2 * np.pi / _HULL_CORNERS)
    radius = circle.radius / np.cos(np.pi / _HULL_CORNERS)
    x, y = circle.center
    return np.column_stack([x + radius * np.cos(angle), y + radius * np.sin(angle)])


def _shapely_of(part: Part, quarter: int) -> Any:
    import shapely

    if isinstance(part, Circle):
        return shapely.Point(part.center).buffer(part.radius, quad_segs=quarter)
    if isinstance(part, Polygon):
        return shapely.Polygon(part.corners)
    if isinstance(part, Cells):
        return shapely.MultiLineString([shapely.LinearRing(ring) for ring in part.grid.outline()])
    return (shapely.LinearRing if part.closed else shapely.LineString)(part.points)


def _core_of(part: Part) -> core.Part:
    if isinstance(part, Circle):
        return core.Circle(radius=part.radius, center=part.center)
    if isinstance(part, Cells):
        return core.GridCells(grid=part.grid)
    if isinstance(part, Polygon):
        return core.Polygon(vertices=part.corners.tolist())
    return (core.Room if part.closed else core.Linestring)(vertices=part.points.tolist())
