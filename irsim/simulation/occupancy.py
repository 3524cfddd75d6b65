"""Collision queries on occupancy grids that do not need the core."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from irsim.components.maps._site import HALF

__all__ = ["grid_collision_geometry", "grid_occupied"]


def grid_occupied(
    grid: Any,
    extent: tuple[float, float, float, float],
    x: float,
    y: float,
    margin_x: float = 0.0,
    margin_y: float = 0.0,
    threshold: float = HALF,
) -> bool:
    """Whether any cell is occupied in the box from (x - margin_x, y - margin_y) to (x + margin_x, y + margin_y).

    Args:
        grid: (nx, ny) occupancy.
        extent: Lower left and upper right corner of the grid [m].
        x: Centre of the box along x [m].
        y: Centre of the box along y [m].
        margin_x: Half the side of the box along x [m].
        margin_y: Half the side of the box along y [m].
        threshold: Cells with a larger occupancy are occupied.

    Returns:
        True also for a box that leaves the grid.
    """
    x0, y0, x1, y1 = extent
    if x - margin_x < x0 or y - margin_y < y0 or x + margin_x > x1 or y + margin_y > y1:
        return True
    nx, ny = grid.shape
    rx, ry = (x1 - x0) / nx, (y1 - y0) / ny
    i0, i1 = (min(max(int((v - x0) / rx), 0), nx - 1) for v in (x - margin_x, x + margin_x))
    j0, j1 = (min(max(int((v - y0) / ry), 0), ny - 1) for v in (y - margin_y, y + margin_y))
    return bool((grid[i0 : i1 + 1, j0 : j1 + 1] > threshold).any())


def grid_collision_geometry(
    grid: Any, grid_reso: Sequence[float], geometry: Any, world_offset: Sequence[float] = (0.0, 0.0)
) -> bool:
    """Whether a shapely geometry touches or overlaps an occupied cell; the edges of a cell belong to it.

    Args:
        grid: (nx, ny) occupancy, occupied above 50; None stands for a grid without occupied cells.
        grid_reso: Size of a cell along x and y [m].
        geometry: Geometry in the world frame [m].
        world_offset: Lower left corner of the grid [m].
    """
    import shapely

    if grid is None or geometry.is_empty:
        return False
    x, y = (float(v) for v in world_offset[:2])
    dx, dy = (float(v) for v in np.asarray(grid_reso).reshape(-1)[:2])
    occupied = np.asarray(grid) > HALF
    nx, ny = occupied.shape
    low_x, low_y, high_x, high_y = geometry.bounds
    # one more cell on each side, because rounding could miss a cell that is only touched; shapely decides exactly
    i0, i1 = (int(np.clip(np.floor((v - x) / dx), -1, nx)) for v in (low_x, high_x))
    j0, j1 = (int(np.clip(np.floor((v - y) / dy), -1, ny)) for v in (low_y, high_y))
    i0, j0 = max(i0 - 1, 0), max(j0 - 1, 0)
    i, j = np.nonzero(occupied[i0 : i1 + 2, j0 : j1 + 2])
    i, j = i + i0, j + j0
    boxes = shapely.box(x + i * dx, y + j * dy, x + (i + 1) * dx, y + (j + 1) * dy)
    shapely.prepare(geometry)
    return bool(shapely.intersects(geometry, boxes).any())
