"""From outlines to a map: which cells they occupy, and how large cells may be so that walls stay whole."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.grid import SIDES, Bools, Grid, fits_into, fitting_side, grid_over, rows_of, side_notes
from irsim.bridges.maps.regions import keep_part
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Occupancy, Outlined, Outlines
from irsim.common.outline import triangles_of
from irsim.components.maps._site import FREE, OCCUPIED, UNKNOWN

__all__ = ["occupancy_of_outlines", "outlines_within"]

_MARGIN = 0.5
"""Free ground around all outlines [m]."""
_FINEST = 0.005
"""Smallest side that a cell gets by itself [m]."""
_SHARE = 0.005
"""Share of the occupied area by which cells may differ from it, and that walls thinner than a cell may have."""
_LONG = 8
"""Cells around a thin part that is a wall, and no tip of a corner."""


def outlines_within(outlines: Outlines, bounds: tuple[float, float, float, float] | None) -> list[Outlined]:
    """All things, or their parts within bounds [m].

    Raises:
        BridgeError: There are no such parts.
    """
    things = outlines.things
    if bounds is not None:
        box = shapely.box(*bounds)
        inside = [
            thing if box.contains(thing.region) else Outlined(thing.name, thing.region.intersection(box))
            for thing in things
        ]
        things = [thing for thing in inside if thing.region.area > 0]
    if not things and outlines.free is None:
        where = "within the bounds" if bounds is not None else "between --climb and --headroom above the floor"
        what = "; ".join([f"the scene is not usable: nothing stands {where}", *outlines.notes])
        raise BridgeError("bridge-file", what, "check them, and --height")
    return things


def occupancy_of_outlines(outlines: Outlines, options: ImportOptions, limits: ImportLimits) -> Occupancy:
    """The map of outlines: cells whose centers are inside are occupied.

    Without ``--resolution`` cells become smaller until they have the area of the outlines, and larger if there would be
    too many. Walls thinner than a cell are as thick as one.

    Raises:
        BridgeError: Nothing stands in the way, or there are too many cells for a resolution that was asked for.
    """
    things = outlines_within(outlines, options.bounds)
    if outlines.solid is None:
        solid = shapely.union_all([thing.region for thing in things])
    else:
        solid = outlines.solid if options.bounds is None else outlines.solid.intersection(shapely.box(*options.bounds))
    low, high = _extent(outlines, solid, options)
    side = fitting_side(options.resolution, low, high, limits.cells)
    if options.resolution is None and side == SIDES[0]:
        side = _fine_side(solid, low, high, limits)
    notes = [*outlines.notes, *side_notes(options.resolution, side)]
    grid = grid_over(low, high, side, limits.cells, ", a part of it with --bounds")
    thin = _thin_walls(solid, side)
    values = np.full((grid.nx, grid.ny), FREE)
    if outlines.free is not None:
        values[~_painted(outlines.free, grid)] = UNKNOWN
    values[_painted(solid, grid)] = OCCUPIED
    if thin:
        values[_painted(shapely.union_all(thin), grid, touched=True)] = OCCUPIED
        notes.append(f"walls thinner than a cell of {side:g} m are as thick as one; try --resolution {side / 2:g}")
    result = Occupancy(values, grid, outlines.frame, outlines.height, outlines.meters_per_unit, notes=notes)
    result.things = things
    result.headroom, result.climb, result.parts = outlines.headroom, outlines.climb, outlines.parts
    keep_part(result, options.seed_point)
    return result


def _extent(outlines: Outlines, solid: Any, options: ImportOptions) -> tuple[Any, Any]:
    """Lower and upper corner of the map [m]."""
    if options.bounds is not None:
        return np.array(options.bounds[:2]), np.array(options.bounds[2:])
    around = shapely.total_bounds([part for part in (solid, outlines.free) if part is not None])
    low, high = around[:2] - _MARGIN, around[2:] + _MARGIN
    if outlines.ground is not None:
        low, high = np.minimum(low, outlines.ground[:2]), np.maximum(high, outlines.ground[2:])
    return low, high


def _narrow(solid: Any, width: float) -> tuple[Any, Any]:
    """Polygons of an area: of each the part that is at least as wide as that [m], and the rest.

    One after the other, as it takes far longer for all at once.
    """
    parts, half = shapely.get_parts(solid), 0.499 * width
    with np.errstate(invalid="ignore"):  # corners that lie in one point
        inner = shapely.buffer(parts, -half, join_style="mitre")
        wide = shapely.buffer(shapely.buffer(inner, half, join_style="mitre"), 1e-9)
    return wide, shapely.difference(parts, wide)


def _thin_walls(solid: Any, side: float) -> list[Any]:
    """The parts of an area that are thinner than a cell, and stand by themselves rather than along a wider part."""
    wide, rest = _narrow(solid, side)
    parts, of = shapely.get_parts(rest, return_index=True)
    long = shapely.length(parts) > _LONG * side
    parts, of = parts[long], of[long]
    near = shapely.buffer(wide[of], 1e-6)
    along = shapely.length(shapely.intersection(shapely.boundary(parts), near))
    return list(parts[along < 0.3 * shapely.length(parts)])


def _fine_side(solid: Any, low: Any, high: Any, limits: ImportLimits) -> float:
    """The usual side of cells, halved until cells have the area of the outlines, or there would be too many [m]."""
    side = SIDES[0]
    while side / 2 >= _FINEST and not _fits(solid, side) and fits_into(low, high, side / 2, limits.cells):
        side /= 2
    return side


def _fits(solid: Any, side: float) -> bool:
    """Whether no wall is thinner than a cell, and cells have the area of the outlines."""
    if solid.is_empty:
        return True
    if shapely.area(_narrow(solid, side)[1]).sum() > _SHARE * solid.area:
        return False
    low, high = np.split(np.array(solid.bounds), 2)
    cells = _painted(solid, grid_over(low, high, side, 1 << 40)).sum()
    return bool(abs(cells * side**2 - solid.area) <= _SHARE * solid.area)


def _painted(region: Any, grid: Grid, *, touched: bool = False) -> Bools:
    """(nx, ny) cells whose centers are in an area, or that it touches."""
    result = np.zeros((grid.nx, grid.ny), bool)
    corners = (triangles_of(region) - [grid.x, grid.y]) / grid.resolution
    for _, i, j, _ in rows_of(np.clip(corners, 0, [grid.nx - 1e-6, grid.ny - 1e-6]), at_centers=not touched):
        result[i, j] = True
    return result
