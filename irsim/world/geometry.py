"""Bodies as shapely geometries, for scripts that ask; the engine never uses them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from irsim.simulation import Simulation

__all__ = ["shapely_geometry"]

_QUADRANT_SEGMENTS = 16


def shapely_geometry(simulation: Simulation, row: int, *, world_frame: bool) -> Any:
    """The body of a row: Polygon, LineString or the union of the parts of a compound.

    Circles become polygons of 64 vertices, as users of IR-SIM know them.
    """
    import shapely

    state = simulation.state
    parts: list[Any] = []
    for part, kind in enumerate(state.parts(row)):
        if kind == "circle":
            x, y, radius = state.circle(row, part, world_frame)
            parts.append(shapely.Point(x, y).buffer(radius, quad_segs=_QUADRANT_SEGMENTS))
        elif kind == "polygon":
            parts.append(shapely.Polygon(state.vertices(row, part, world_frame)))
        else:
            parts.append(shapely.LineString(state.vertices(row, part, world_frame)))
    return parts[0] if len(parts) == 1 else shapely.union_all(parts)
