"""Maps for planners: a rectangle of the world with a grid of occupied cells and a list of obstacles."""

from __future__ import annotations

import math
import warnings
import zlib
from collections.abc import Sequence
from typing import Any, Protocol, runtime_checkable

import numpy as np

import irsim._core as core
from irsim.components.maps._grid import with_unknown
from irsim.components.maps._site import HALF
from irsim.objects.shapely_geometry import body_parts, parts_of
from irsim.objects.view import ObjectView
from irsim.simulation.occupancy import grid_occupied

__all__ = ["EnvGridMap", "Map", "coarsen", "terrain_of", "world_map"]

MAX_EQUAL_RATIO = 1.05
"""A resolution up to this many times the cell size of the grid of the world counts as equal to it."""
MIN_EQUAL_RATIO = 0.95
"""A resolution down to this many times the cell size of the grid of the world counts as equal to it."""


@runtime_checkable
class EnvGridMap(Protocol):
    """The part of a map that planners need."""

    width: float
    height: float
    resolution: float
    obstacle_list: list[Any]
    grid: Any
    world_offset: tuple[float, float]

    @property
    def grid_resolution(self) -> tuple[float, float] | None:
        """Size of a cell of the grid along x and y [m], or None."""

    def grid_occupied(
        self, x: float, y: float, margin_x: float = 0.0, margin_y: float = 0.0, threshold: float = HALF
    ) -> bool | None:
        """Whether a cell near (x, y) is occupied; None without a grid."""

    def is_collision(self, geometry: Any) -> bool:
        """Whether a shapely geometry collides with an obstacle or leaves the map."""


class Map:
    """A rectangle of the world in which planners search.

    Args:
        width, height: Extent [m].
        resolution: Cell size of grid planners if there is no grid [m].
        obstacle_list: Obstacles: objects of an environment, shapely geometries, or anything with an attribute
            ``geometry``. Objects that are ``unobstructed`` are ignored.
        grid: (nx, ny) occupancy 0 to 100, negative where unknown, which planners avoid; cell [i, j] with i along +x and
            j along +y from the lower left corner.
        world_offset: Lower left corner [m].

    Attributes:
        robot: Default robot whose footprint grid planners use; None stands for a footprint of one cell.
        seed: (seed, scene, noise episode) for the samples of planners; None stands for fresh entropy.
        canvas: Returns the Matplotlib axes for ``show_animation``, or None.
    """

    def __init__(
        self,
        width: float = 10,
        height: float = 10,
        resolution: float = 0.1,
        obstacle_list: Sequence[Any] | None = None,
        grid: Any = None,
        world_offset: Sequence[float] = (0.0, 0.0),
    ) -> None:
        self.width, self.height, self.resolution = float(width), float(height), float(resolution)
        if not (self.width > 0 and self.height > 0 and self.resolution > 0):
            raise ValueError("width, height and resolution of a map must be positive")
        self.obstacle_list: list[Any] = list(obstacle_list or [])
        self.grid: Any = None if grid is None else np.asarray(grid)
        if self.grid is not None and (self.grid.ndim != 2 or not self.grid.size):
            raise ValueError("the grid of a map must have two dimensions: columns along x, rows along y")
        self.world_offset = (float(world_offset[0]), float(world_offset[1]))
        self.robot: Any = None
        self.seed: tuple[int, int, int] | None = None
        self.canvas: Any = None
        self._terrain: tuple[Any, core.Terrain] | None = None
        self._cells: tuple[Any, core.OccupancyGrid] | None = None

    def share_cells(self, cells: core.OccupancyGrid) -> None:
        """Use ``cells``, the core's form of the grid, as long as ``grid`` is not changed."""
        if self.grid is not None and cells.shape == self.grid.shape:
            self._cells = self.grid.copy(), cells

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Lower left and upper right corner [m]."""
        x, y = self.world_offset
        return x, y, x + self.width, y + self.height

    @property
    def grid_resolution(self) -> tuple[float, float] | None:
        """Size of a cell of the grid along x and y [m], or None."""
        return None if self.grid is None else (self.width / self.grid.shape[0], self.height / self.grid.shape[1])

    def grid_occupied(
        self, x: float, y: float, margin_x: float = 0.0, margin_y: float = 0.0, threshold: float = HALF
    ) -> bool | None:
        """Whether any cell is occupied in the box from (x - margin_x, y - margin_y) to (x + margin_x, y + margin_y).

        Returns:
            True also for a box that leaves the map; None without a grid.
        """
        if self.grid is None:
            return None
        return grid_occupied(self.grid, self.bounds, x, y, margin_x, margin_y, threshold)

    def is_collision(self, geometry: Any) -> bool:
        """Whether a shapely geometry leaves the map, or touches or overlaps an occupied cell or an obstacle."""
        return terrain_of(self).collides(parts_of(geometry), (0.0, 0.0, 0.0))


def world_map(
    width: float,
    height: float,
    corner: tuple[float, float],
    grid: Any,
    resolution: float,
    obstacles: Sequence[Any] | None = None,
) -> Map:
    """Return the map of a world.

    Args:
        width: Extent along x [m].
        height: Extent along y [m].
        corner: Lower left corner [m].
        grid: (nx, ny) occupancy of the world, or None.
        resolution: Cell size [m]. Cells of the grid can be merged (a merged cell is occupied if any of its parts is)
            but not divided; the map then keeps the value, but it uses the cells of the grid. A value that is not
            positive stands for the resolution of the grid.
        obstacles: Obstacles in the world.
    """
    try:
        resolution = float(resolution)
    except (TypeError, ValueError):
        raise TypeError(f"the resolution of a map must be a number [m], got {resolution!r}") from None
    if grid is None:
        if not (math.isfinite(resolution) and resolution > 0):
            raise ValueError("the map of a world without a grid must have a positive resolution")
        return Map(width, height, resolution, obstacles, None, corner)
    grid_resolution = width / grid.shape[0]
    reason = f"the grid of the world has cells of {grid_resolution:g} m"
    if not math.isfinite(resolution):
        warnings.warn(f"a resolution of {resolution} m means nothing: {reason}, which stay", UserWarning, stacklevel=3)
        resolution = grid_resolution
    elif not resolution > 0:
        resolution = grid_resolution
    elif resolution > MAX_EQUAL_RATIO * grid_resolution:
        merged = coarsen(grid, round(width / resolution), round(height / resolution))
        size = width / merged.shape[0], height / merged.shape[1]
        even = all(math.isclose(extent, resolution, rel_tol=1e-9) for extent in size)
        rest = "" if even else f", in fact {size[0]:.4g} m x {size[1]:.4g} m because the world is not a multiple of it"
        warnings.warn(f"{reason}: they are merged to cells of {resolution:g} m{rest}", UserWarning, stacklevel=3)
        grid = merged
    elif resolution < MIN_EQUAL_RATIO * grid_resolution:
        warnings.warn(f"{reason}: they cannot be divided into cells of {resolution:g} m", UserWarning, stacklevel=3)
    return Map(width, height, resolution, obstacles, grid, corner)


def coarsen(grid: Any, columns: int, rows: int) -> Any:
    """Merge cells to blocks, each with the largest value of its cells; unknown without occupied and with unknown cells.

    Args:
        grid: (nx, ny) values, negative where unknown.
        columns: Number of blocks along x, at most nx.
        rows: Number of blocks along y, at most ny.

    Returns:
        (columns, rows) array.
    """
    values = np.asarray(grid)
    columns, rows = min(max(1, columns), values.shape[0]), min(max(1, rows), values.shape[1])
    # a cell counts for each block that it overlaps
    most, least = values, values
    for axis, count in ((0, columns), (1, rows)):
        size = values.shape[axis]
        first = np.arange(count) * size // count
        last = -(-(np.arange(1, count + 1) * size) // count)
        blocks = [range(a, b) for a, b in zip(first, last, strict=True)]
        most = np.stack([np.take(most, block, axis=axis).max(axis=axis) for block in blocks], axis=axis)
        least = np.stack([np.take(least, block, axis=axis).min(axis=axis) for block in blocks], axis=axis)
    return with_unknown(most, least)


def terrain_of(env_map: Any) -> core.Terrain:
    """Return the core's form of a map; it is cached in the map until the map or one of its obstacles changes."""
    signature = _signature(env_map)
    kept = getattr(env_map, "_terrain", None)
    if kept is not None and kept[0] == signature:
        terrain: core.Terrain = kept[1]
        return terrain
    x, y = env_map.world_offset
    things: list[tuple[list[Any], tuple[float, float, float]]] = [
        (parts_of(thing), (0.0, 0.0, 0.0))
        for thing in env_map.obstacle_list
        if not getattr(thing, "unobstructed", False)
        and not (env_map.grid is not None and getattr(thing, "shape", None) == "map")  # already in the grid
    ]
    things += [([cells], (0.0, 0.0, 0.0)) for cells in _grid_parts(env_map)]
    terrain = core.Terrain((x, y, x + env_map.width, y + env_map.height), things)
    if isinstance(env_map, Map):
        env_map._terrain = signature, terrain
    return terrain


def _grid_parts(env_map: Any) -> list[Any]:
    """Return the grid as a list of one part of the core; an empty list without occupied or unknown cells."""
    if env_map.grid is None:
        return []
    origin, cell, _, _ = cells_of(env_map)
    kept = getattr(env_map, "_cells", None)
    if kept is not None and (kept[1].origin, kept[1].cell) == (origin, cell) and np.array_equal(kept[0], env_map.grid):
        return [core.GridCells(grid=kept[1])] if kept[1].closed_count else []
    values = np.asarray(env_map.grid)
    occupied, unknown = (np.ascontiguousarray(chosen, dtype=np.uint8) for chosen in (values > HALF, values < 0))
    cells = core.OccupancyGrid(occupied, origin, cell, unknown)
    return [core.GridCells(grid=cells)] if cells.closed_count else []


Cells = tuple[tuple[float, float], tuple[float, float], int, int]
"""Origin [m], size of a cell [m], number of columns and of rows of the cells that a planner searches."""


def cells_of(env_map: Any, resolution: float | None = None) -> Cells:
    """Return the cells that grid planners use: cells of ``resolution`` [m], or without it the cells of the grid."""
    if resolution is None and env_map.grid is not None:
        nx, ny = env_map.grid.shape
    else:
        size = env_map.resolution if resolution is None else resolution
        nx, ny = (max(1, round(extent / size)) for extent in (env_map.width, env_map.height))
    return (env_map.world_offset[0], env_map.world_offset[1]), (env_map.width / nx, env_map.height / ny), nx, ny


def footprint_of(robot: Any) -> list[Any]:
    """Return the parts of the footprint of a robot; an empty list without a robot, which means one cell."""
    return [] if robot is None else body_parts(robot)


def _signature(env_map: Any) -> Any:
    """Return a value that changes when anything in the map has moved or been replaced."""
    things = tuple(
        (id(thing), thing.row, thing._simulation.pose[thing.row].tobytes(), thing.record.unobstructed)
        if isinstance(thing, ObjectView)
        else (id(thing), getattr(thing, "geometry", thing).wkb)
        for thing in env_map.obstacle_list
    )
    grid = env_map.grid
    written = None
    if grid is not None:
        written = id(grid), zlib.crc32(np.ascontiguousarray(grid).data) if grid.flags.writeable else 0
    return things, written, env_map.width, env_map.height, tuple(env_map.world_offset)
