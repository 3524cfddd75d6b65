"""Converts bodies to shapely geometries and back, for scripts; the engine never uses shapely."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import irsim._core as core
from irsim.components.maps._grid import MapCells, Walls

if TYPE_CHECKING:
    from irsim.objects.base import SimObject
    from irsim.simulation.simulation import Simulation

__all__ = ["core_parts", "from_shapely", "shapely_geometry", "touching", "touching_circle"]

_QUADRANT_SEGMENTS = 16
"""Number of segments of a quarter circle in the polygon that stands for a circle."""


def shapely_geometry(simulation: Simulation, row: int, *, world_frame: bool) -> Any:
    """Return the body of a row as a shapely Polygon or LineString, or as the union of the parts of a compound.

    Circles become polygons with 64 vertices, as in IR-SIM.
    """
    import shapely

    state = simulation.state
    parts: list[Any] = []
    cells = state.cells(row)
    if cells is not None:
        return shapely.MultiLineString([shapely.LinearRing(ring) for ring in cells.outline()])
    for part, kind in enumerate(state.parts(row)):
        if kind == "circle":
            x, y, radius = state.circle(row, part, world_frame)
            parts.append(shapely.Point(x, y).buffer(radius, quad_segs=_QUADRANT_SEGMENTS))
        elif kind == "polygon":
            parts.append(shapely.Polygon(state.vertices(row, part, world_frame)))
        elif kind == "room":
            parts.append(shapely.LinearRing(state.vertices(row, part, world_frame)))
        else:
            parts.append(shapely.LineString(state.vertices(row, part, world_frame)))
    return parts[0] if len(parts) == 1 else shapely.union_all(parts)


def core_parts(simulation: Simulation, row: int) -> list[core.Part]:
    """Return the parts of the body of a row for the core, in the body frame."""
    shape = simulation.scenario.objects[row % simulation.objects].shape
    if isinstance(shape, (MapCells, Walls)):
        return shape.parts()
    state = simulation.state
    cells = state.cells(row)
    if cells is not None:
        return [core.GridCells(grid=cells)]
    parts: list[core.Part] = []
    for part, kind in enumerate(state.parts(row)):
        if kind == "circle":
            x, y, radius = state.circle(row, part, False)
            parts.append(core.Circle(radius=radius, center=[x, y]))
        else:
            vertices = state.vertices(row, part, False).tolist()
            make: Any = {"polygon": core.Polygon, "linestring": core.Linestring, "room": core.Room}[kind]
            parts.append(make(vertices=vertices))
    return parts


def touching(a: SimObject, b: SimObject) -> bool:
    """Return whether two bodies intersect or touch at their present poses, computed on the exact shapes."""
    first, second = core_parts(a._simulation, a.row), core_parts(b._simulation, b.row)
    return core.intersects(first, a.state[:3, 0].tolist(), second, b.state[:3, 0].tolist())


def touching_circle(a: SimObject, x: float, y: float, radius: float) -> bool:
    """Return whether a body at its present pose intersects or touches a circle, in the world frame [m]."""
    circle = core.Circle(radius=radius, center=[x, y])
    return core.intersects(core_parts(a._simulation, a.row), a.state[:3, 0].tolist(), [circle], [0.0, 0.0, 0.0])


def from_shapely(geometry: Any) -> list[core.Part]:
    """Convert polygons, lines and collections of them to parts for the core; holes are filled.

    Raises:
        ValueError: The geometry is empty or contains points.
    """
    parts: list[core.Part] = []
    for piece in getattr(geometry, "geoms", [geometry]):
        if piece.is_empty:
            continue
        if piece.geom_type == "Polygon":
            parts.append(core.Polygon(vertices=[[x, y] for x, y, *_ in piece.exterior.coords[:-1]]))
        elif piece.geom_type in ("LineString", "LinearRing"):
            parts.append(core.Linestring(vertices=[[x, y] for x, y, *_ in piece.coords]))
        elif hasattr(piece, "geoms"):
            parts += from_shapely(piece)
        else:
            raise ValueError(f"a body is made of polygons and lines, not of a {piece.geom_type}")
    if not parts:
        raise ValueError("the geometry is empty")
    return parts
