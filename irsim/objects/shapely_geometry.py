"""Whether bodies touch, on the exact shapes; and shapely geometries and objects as parts of the core."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.common.outline import outline
from irsim.diagnostics.errors import InputError, InputTypeError
from irsim.objects.view import ObjectView

if TYPE_CHECKING:
    from irsim.objects.base import SimObject

__all__ = ["body_parts", "from_shapely", "is_taken", "parts_of", "touching"]


def touching(a: SimObject, b: SimObject) -> bool:
    """Return whether two bodies intersect or touch at their present poses, computed on the exact shapes."""
    first, second = body_parts(a), body_parts(b)
    return core.intersects(first, a.state[:3, 0].tolist(), second, b.state[:3, 0].tolist())


def is_taken(a: SimObject, parts: Sequence[core.Part], pose: Sequence[float]) -> bool:
    """Return whether a body leaves no room for another one at a pose; a map leaves none in unknown cells either."""
    own, place = body_parts(a), a.state[:3, 0].tolist()
    if isinstance(own[0], core.GridCells):
        return core.Terrain((-1e8, -1e8, 1e8, 1e8), [(own, place)]).collides(parts, pose)
    return core.intersects(own, place, parts, pose)


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
            raise InputError(f"a body is made of polygons and lines, not of a {piece.geom_type}")
    if not parts:
        raise InputError("the geometry is empty")
    return parts


def parts_of(thing: Any) -> list[Any]:
    """Return the area that a thing occupies in the world, as parts of the core.

    Args:
        thing: An object of an environment, a shapely geometry, or anything with an attribute ``geometry``.

    Raises:
        TypeError: The thing has no geometry.
    """
    if isinstance(thing, ObjectView):
        return outline(thing._simulation.state, thing.row, world_frame=True).core()
    return list(_parts(_geometry(thing, "geometry")))


def body_parts(thing: Any) -> list[Any]:
    """Return the body of a thing in the body frame, as parts of the core.

    Args:
        thing: An object of an environment, a shapely geometry in the body frame, or anything with an attribute
            ``original_geometry``.

    Raises:
        TypeError: The thing has no geometry.
    """
    if isinstance(thing, ObjectView):
        return outline(thing._simulation.state, thing.row).core()
    return list(_parts(_geometry(thing, "original_geometry")))


def _geometry(thing: Any, attribute: str) -> Any:
    geometry = getattr(thing, attribute, thing)
    if not hasattr(geometry, "geom_type"):
        raise InputTypeError(f"an obstacle must be an object or a shapely geometry, got {thing!r}")
    return geometry


def _parts(geometry: Any) -> Iterator[Any]:
    if geometry.is_empty:
        return
    kind = geometry.geom_type
    if kind == "Polygon":
        yield core.Polygon(vertices=_ring(geometry))
    elif kind in ("LineString", "LinearRing"):
        yield core.Linestring(vertices=_xy(geometry).tolist())
    elif kind == "Point":
        yield core.Circle(radius=0.0, center=(geometry.x, geometry.y))
    elif hasattr(geometry, "geoms"):
        for one in geometry.geoms:
            yield from _parts(one)
    else:
        raise InputTypeError(f"planners do not support geometries of type {kind!r}")


def _xy(line: Any) -> Floats:
    return np.asarray(line.coords, dtype=np.float64)[:, :2]


def _ring(polygon: Any) -> list[list[float]]:
    """Return the (N, 2) corners of a polygon; a seam, passed in both directions, connects each hole to the outline."""
    ring = _xy(polygon.exterior)[:-1]
    holes = [_xy(hole)[:-1] for hole in polygon.interiors]
    while holes:
        gaps = [((ring[:, None] - hole[None]) ** 2).sum(axis=2) for hole in holes]
        k = int(np.argmin([gap.min() for gap in gaps]))
        hole, gap = holes.pop(k), gaps[k]
        i, j = np.unravel_index(int(gap.argmin()), gap.shape)
        rolled = np.roll(hole, -int(j), axis=0)
        ring = np.vstack([ring[: i + 1], rolled, rolled[:1], ring[i:]])
    return [[float(x), float(y)] for x, y in ring]
