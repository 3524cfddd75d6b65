"""Whether bodies touch, on the exact shapes; and shapely geometries as parts of the core, for scripts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import irsim._core as core
from irsim.common.outline import outline

if TYPE_CHECKING:
    from irsim.objects.base import SimObject

__all__ = ["from_shapely", "touching", "touching_circle"]


def touching(a: SimObject, b: SimObject) -> bool:
    """Return whether two bodies intersect or touch at their present poses, computed on the exact shapes."""
    first, second = _parts(a), _parts(b)
    return core.intersects(first, a.state[:3, 0].tolist(), second, b.state[:3, 0].tolist())


def touching_circle(a: SimObject, x: float, y: float, radius: float) -> bool:
    """Return whether a body at its present pose intersects or touches a circle, in the world frame [m]."""
    circle = core.Circle(radius=radius, center=[x, y])
    return core.intersects(_parts(a), a.state[:3, 0].tolist(), [circle], [0.0, 0.0, 0.0])


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


def _parts(thing: SimObject) -> list[core.Part]:
    return outline(thing._simulation.state, thing.row).core()
