"""Distances to the obstacles of a scene on a grid, and the width of the narrowest gap on a path."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.validation.feasibility.movers import Mover
from irsim.validation.feasibility.scenes import FAR, StartState

__all__ = [
    "ClearanceGrid",
    "Gap",
    "cells_over",
    "free_place",
    "grid_of",
    "narrowest_gap",
    "reachable_place",
    "with_gaps_closed",
]

Point = tuple[float, float]
Box = tuple[float, float, float, float]
_MAX_CELLS = 150_000
"""Greatest number of cells of a grid over the world."""
_MAX_ROUGH_CELLS = 40_000
"""Greatest number of cells of a grid over the world if several scenes are examined."""
_CELLS_PER_RADIUS = 4
"""Cells along the radius of the smallest mover, unless that takes too many cells."""
_REFINEMENT = 10.0
"""Factor by which the cells shrink in each round of measuring a gap."""
_MAX_FINE_CELLS = (20_000, 60_000)
"""Greatest number of cells in each round of measuring a gap."""
_MAX_MEASURED = 4
"""Number of narrow places on a path that are measured."""
_MAX_TRIED_PLACES = 400
"""Number of free places that are tried, evenly spread, before the best of them is refined."""
_HALF_DIAGONAL = math.sqrt(0.5)
"""Half the diagonal of a square cell of size 1."""


@dataclass
class ClearanceGrid:
    """Distances to the obstacles of a scene, on the cells of a rectangle.

    Attributes:
        scene: The scene.
        box: The rectangle: x and y of its lower left and upper right corner [m].
        cells: Origin, size and number of the cells.
        clearance: Distances to obstacles, and paths through the cells.
        half: Half the diagonal of a cell [m], the largest error of a distance.
    """

    scene: StartState
    box: Box
    cells: core.Cells
    clearance: core.Clearance
    half: float
    _distance: NDArray[np.float32] | None = field(default=None, repr=False)

    @property
    def cell(self) -> float:
        """Size of a cell [m]."""
        return max(self.cells[1])

    @property
    def distance(self) -> NDArray[np.float32]:
        """(nx, ny) distances [m]."""
        if self._distance is None:
            self._distance = self.clearance.distance
        return self._distance

    def holds(self, point: Point) -> bool:
        """Whether a point lies in the rectangle."""
        x0, y0, x1, y1 = self.box
        return x0 <= point[0] <= x1 and y0 <= point[1] <= y1

    def at(self, points: NDArray[np.float64]) -> NDArray[np.float32]:
        """(K,) distances at the cells of (K, 2) points."""
        (x0, y0), (dx, dy), nx, ny = self.cells
        i = np.clip(((points[:, 0] - x0) / dx).astype(int), 0, nx - 1)
        j = np.clip(((points[:, 1] - y0) / dy).astype(int), 0, ny - 1)
        values: NDArray[np.float32] = self.distance[i, j]
        return values


def cells_over(box: Box, size: float, most: int) -> core.Cells:
    """Cells of about ``size`` [m] over a rectangle, larger ones if that takes more than ``most`` cells."""
    width, height = box[2] - box[0], box[3] - box[1]
    size = max(size, math.sqrt(width * height / most), width / most, height / most)
    nx, ny = max(1, math.ceil(width / size)), max(1, math.ceil(height / size))
    return (box[0], box[1]), (width / nx, height / ny), nx, ny


def grid_of(scene: StartState, movers: list[Mover], margin: float = 0.0) -> ClearanceGrid:
    """The grid over the world and a margin [m] around it, computed once for scenes with the same obstacles."""
    kept, key = scene.owner.kept, f"grid {margin}"
    if key not in kept:
        kept[key] = _around(scene.owner, movers, margin)
    grid: ClearanceGrid = kept[key]
    return grid


def _around(scene: StartState, movers: list[Mover], margin: float) -> ClearanceGrid:
    x0, y0, x1, y1 = scene.bounds
    box = (x0 - margin, y0 - margin, x1 + margin, y1 + margin)
    finest = min(mover.radius for mover in movers) / _CELLS_PER_RADIUS
    cells = cells_over(box, finest, _MAX_ROUGH_CELLS if scene.rough else _MAX_CELLS)
    return _make_grid(scene, box, cells)


def with_gaps_closed(grid: ClearanceGrid, gaps: list[Gap]) -> ClearanceGrid:
    """A copy of the grid in which some gaps are filled with obstacles."""
    plugs = [([core.Circle(radius=max(g.width / 2, grid.half), center=[0, 0])], [*g.place, 0.0]) for g in gaps]
    terrain = core.Terrain(FAR, [*grid.scene.owner.things, *plugs])
    return ClearanceGrid(grid.scene, grid.box, grid.cells, core.Clearance(terrain, grid.cells), grid.half)


def _make_grid(scene: StartState, box: Box, cells: core.Cells) -> ClearanceGrid:
    half = _HALF_DIAGONAL * max(cells[1]) * (1 + 1e-9)
    return ClearanceGrid(scene, box, cells, core.Clearance(scene.terrain, cells), half)


@dataclass(frozen=True)
class Gap:
    """A gap between two obstacles.

    Attributes:
        width: Width of the gap, 0 if it is closed [m].
        place: Position of its middle [m].
        slack: Largest error of the width [m].
    """

    width: float
    place: Point
    slack: float


def narrowest_gap(grid: ClearanceGrid, start: Point, goal: Point) -> Gap | None:
    """The narrowest gap on the widest path; None if there is no path, or no obstacle beside it."""
    width, x, y = grid.clearance.widest(start, goal, 0.0)
    if not math.isfinite(width):
        return None
    way = grid.clearance.way(start, goal, width - 1e-9)
    if not len(way):
        return Gap(2 * width, (x, y), 2 * grid.half)
    along = grid.at(way)
    lower = np.concatenate([[True], along[1:] <= along[:-1]]) & np.concatenate([along[:-1] <= along[1:], [True]])
    tight = np.flatnonzero(lower & (along <= width + grid.half))
    tight = tight[np.argsort(along[tight], kind="stable")]
    narrowest = np.argmin(np.hypot(*(way - (x, y)).T))  # where a path keeps close to walls, much of it seems as tight
    measured = dict.fromkeys([int(narrowest), *tight.tolist()])
    return min((_measure_gap(grid, way, k) for k in list(measured)[:_MAX_MEASURED]), key=lambda gap: gap.width)


def _measure_gap(grid: ClearanceGrid, way: NDArray[np.float64], k: int) -> Gap:
    """The gap at point ``k`` of a path, measured on finer cells around it."""
    width, place = float(grid.at(way[k : k + 1])[0]), _point(way[k])
    for most in _MAX_FINE_CELLS:
        start, goal = _point(way[max(0, k - 4)]), _point(way[min(len(way) - 1, k + 4)])
        side = max(math.dist(start, place), math.dist(goal, place)) + width + 2 * grid.cell
        box = (place[0] - side, place[1] - side, place[0] + side, place[1] + side)
        grid = _make_grid(grid.scene, box, cells_over(box, grid.cell / _REFINEMENT, most))
        start, goal = (
            grid.clearance.climb(end, side / 2) for end in (start, goal)
        )  # away from obstacles at the ends, so that only the gap is measured
        fine, x, y = grid.clearance.widest(start, goal, 0.0)
        if not math.isfinite(fine):
            return Gap(0.0, place, 0.0)
        width, place = fine, (x, y)
        way = grid.clearance.way(start, goal, width - 1e-9)
        if not len(way):
            break
        k = int(np.argmin(grid.at(way)))
        place = _point(way[k])
    return Gap(2 * width + grid.half, place, grid.half) if width > 1.5 * grid.cell else Gap(0.0, place, 0.0)


def _point(row: Any) -> Point:
    return float(row[0]), float(row[1])


def free_place(grid: ClearanceGrid, near: Point, radius: float, other: Point | None = None) -> Point | None:
    """The nearest place where a disc fits, if possible one that can be reached from ``other``.

    Args:
        grid: The grid.
        near: Position from which the distance counts [m].
        radius: Radius of the disc [m].
        other: Position from which the place should be reachable [m].
    """
    reached = None if other is None else reachable_place(grid, near, radius, other, radius - grid.half)
    if reached is not None:
        return reached
    places = _places(grid, near, radius)
    return _point(places[0]) if len(places) else None


def reachable_place(grid: ClearanceGrid, near: Point, radius: float, other: Point, width: float) -> Point | None:
    """The nearest place where a disc fits and from which a path leads to ``other``; None without a way.

    Args:
        grid: The grid.
        near: Position from which the distance counts [m].
        radius: Radius of the disc [m].
        other: Position to which the path must lead [m].
        width: Least distance of the path to obstacles [m].
    """
    places = _places(grid, near, radius)
    stride = max(1, len(places) // _MAX_TRIED_PLACES)
    for k in range(0, len(places), stride):
        if _is_connected(grid, other, places[k], width):
            nearer = range(max(0, k - stride + 1), k)
            return next(
                (_point(places[n]) for n in nearer if _is_connected(grid, other, places[n], width)), _point(places[k])
            )
    return None


def _is_connected(grid: ClearanceGrid, other: Point, place: NDArray[np.float64], width: float) -> bool:
    return grid.clearance.widest(other, _point(place), 0.0)[0] >= width


def _places(grid: ClearanceGrid, near: Point, radius: float) -> NDArray[np.float64]:
    """(K, 2) middles [m] of the cells where a disc fits, the nearest first."""
    i, j = np.nonzero(grid.distance >= radius + 0.5 * grid.cell)
    (x0, y0), (dx, dy), _, _ = grid.cells
    places = np.stack([x0 + (i + 0.5) * dx, y0 + (j + 0.5) * dy], axis=1)
    nearest: NDArray[np.float64] = places[np.argsort(np.hypot(*(places - np.array(near)).T), kind="stable")]
    return nearest
