"""Room between the things of a scene: distances on a lattice, and the width of the narrowest gap on a way."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.validation.feasibility.movers import Mover
from irsim.validation.feasibility.scenes import FAR, Scene

__all__ = ["Gap", "Room", "cells_over", "free_place", "gap", "plugged", "reached_place", "room_of"]

Point = tuple[float, float]
Box = tuple[float, float, float, float]
_CELLS, _ROUGH_CELLS = 150_000, 40_000
_PER_RADIUS = 4
_FINER, _FINE_CELLS = 10.0, (20_000, 60_000)
"""Cells are so much finer in each round of measuring a gap, if there are not more than so many."""
_MOST_TIGHT = 4
_MOST_TRIED = 400
"""Places that are looked at, evenly, before the best of them is refined."""
_HALF_DIAGONAL = math.sqrt(0.5)


@dataclass
class Room:
    """Room over a rectangle.

    Attributes:
        scene: Whose.
        box: The rectangle [m].
        cells: Its cells.
        clearance: Distances and ways.
        half: Half the diagonal of a cell: no distance is farther off than this [m].
    """

    scene: Scene
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
    """Cells of about a size over a rectangle, larger ones if there would be too many."""
    width, height = box[2] - box[0], box[3] - box[1]
    size = max(size, math.sqrt(width * height / most), width / most, height / most)
    nx, ny = max(1, math.ceil(width / size)), max(1, math.ceil(height / size))
    return (box[0], box[1]), (width / nx, height / ny), nx, ny


def room_of(scene: Scene, movers: list[Mover], margin: float = 0.0) -> Room:
    """Room over the world, and so much around it; made once for scenes with the same things."""
    kept, key = scene.owner.kept, f"room {margin}"
    if key not in kept:
        kept[key] = _around(scene.owner, movers, margin)
    room: Room = kept[key]
    return room


def _around(scene: Scene, movers: list[Mover], margin: float) -> Room:
    x0, y0, x1, y1 = scene.bounds
    box = (x0 - margin, y0 - margin, x1 + margin, y1 + margin)
    finest = min(mover.radius for mover in movers) / _PER_RADIUS
    cells = cells_over(box, finest, _ROUGH_CELLS if scene.rough else _CELLS)
    return _room(scene, box, cells)


def plugged(room: Room, gaps: list[Gap]) -> Room:
    """The same with these gaps closed."""
    plugs = [([core.Circle(radius=max(g.width / 2, room.half), center=[0, 0])], [*g.place, 0.0]) for g in gaps]
    terrain = core.Terrain(FAR, [*room.scene.owner.things, *plugs])
    return Room(room.scene, room.box, room.cells, core.Clearance(terrain, room.cells), room.half)


def _room(scene: Scene, box: Box, cells: core.Cells) -> Room:
    half = _HALF_DIAGONAL * max(cells[1]) * (1 + 1e-9)
    return Room(scene, box, cells, core.Clearance(scene.terrain, cells), half)


@dataclass(frozen=True)
class Gap:
    """A place between two things.

    Attributes:
        width: How wide, 0 if there is no opening [m].
        place: Where [m].
        slack: It may be wider or narrower by so much [m].
    """

    width: float
    place: Point
    slack: float


def gap(room: Room, start: Point, goal: Point) -> Gap | None:
    """The narrowest gap on the widest way; None if there is no such way, or nothing beside it."""
    width, x, y = room.clearance.widest(start, goal, 0.0)
    if not math.isfinite(width):
        return None
    way = room.clearance.way(start, goal, width - 1e-9)
    if not len(way):
        return Gap(2 * width, (x, y), 2 * room.half)
    along = room.at(way)
    lower = np.concatenate([[True], along[1:] <= along[:-1]]) & np.concatenate([along[:-1] <= along[1:], [True]])
    tight = np.flatnonzero(lower & (along <= width + room.half))
    tight = tight[np.argsort(along[tight], kind="stable")][:_MOST_TIGHT]
    return min((_measured(room, way, int(k)) for k in tight), key=lambda found: found.width)


def _measured(room: Room, way: NDArray[np.float64], k: int) -> Gap:
    """The gap by a point of a way, on finer cells around it."""
    width, place = float(room.at(way[k : k + 1])[0]), _point(way[k])
    for most in _FINE_CELLS:
        start, goal = _point(way[max(0, k - 4)]), _point(way[min(len(way) - 1, k + 4)])
        side = max(math.dist(start, place), math.dist(goal, place)) + width + 2 * room.cell
        box = (place[0] - side, place[1] - side, place[0] + side, place[1] + side)
        room = _room(room.scene, box, cells_over(box, room.cell / _FINER, most))
        start, goal = (room.clearance.climb(end, side / 2) for end in (start, goal))  # the gap counts, not its ends
        fine, x, y = room.clearance.widest(start, goal, 0.0)
        if not math.isfinite(fine):
            return Gap(0.0, place, 0.0)
        width, place = fine, (x, y)
        way = room.clearance.way(start, goal, width - 1e-9)
        if not len(way):
            break
        k = int(np.argmin(room.at(way)))
        place = _point(way[k])
    return Gap(2 * width + room.half, place, room.half) if width > 1.5 * room.cell else Gap(0.0, place, 0.0)


def _point(row: Any) -> Point:
    return float(row[0]), float(row[1])


def free_place(room: Room, near: Point, radius: float, other: Point | None = None) -> Point | None:
    """The nearest cell with room for a disc, if possible one that ``other`` can be reached from."""
    reached = None if other is None else reached_place(room, near, radius, other, radius - room.half)
    if reached is not None:
        return reached
    places = _places(room, near, radius)
    return _point(places[0]) if len(places) else None


def reached_place(room: Room, near: Point, radius: float, other: Point, width: float) -> Point | None:
    """The nearest cell with room for a disc and a way to ``other`` that keeps ``width`` [m] from everything."""
    places = _places(room, near, radius)
    stride = max(1, len(places) // _MOST_TRIED)
    for k in range(0, len(places), stride):
        if _leads(room, other, places[k], width):
            nearer = range(max(0, k - stride + 1), k)
            return next((_point(places[n]) for n in nearer if _leads(room, other, places[n], width)), _point(places[k]))
    return None


def _leads(room: Room, other: Point, place: NDArray[np.float64], width: float) -> bool:
    return room.clearance.widest(other, _point(place), 0.0)[0] >= width


def _places(room: Room, near: Point, radius: float) -> NDArray[np.float64]:
    """(K, 2) middles of the cells with room for a disc, the nearest first."""
    i, j = np.nonzero(room.distance >= radius + 0.5 * room.cell)
    (x0, y0), (dx, dy), _, _ = room.cells
    places = np.stack([x0 + (i + 0.5) * dx, y0 + (j + 0.5) * dy], axis=1)
    nearest: NDArray[np.float64] = places[np.argsort(np.hypot(*(places - np.array(near)).T), kind="stable")]
    return nearest
