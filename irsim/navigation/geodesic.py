"""Shortest paths around static obstacles."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.common.outline import Circle, Polygon, outline
from irsim.simulation.roles import STATIC, kinds_of

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["Geodesics", "inscribed_radius"]

_MAX_CELL_M = 0.05
"""Largest cell [m]; cells are half the radius of the disc where that is less."""
_MAX_CELLS = 250_000
"""Number of cells beyond which larger cells are used."""
_COARSE_FACTOR = 4.0
"""Factor by which coarse cells are larger."""
_SLACK_M = 1e-3
"""Length [m] by which the disc is smaller than the body, which may touch obstacles."""
_MIN_RADIUS_M = 0.01
"""Smallest radius of the disc [m]."""


class Geodesics:
    """Shortest paths of a disc among the static objects of one world: any-angle smoothed A* on the inflated map.

    Cells are 0.05 m or half the radius, whichever is less, and larger in worlds of more than 250,000 such cells. A
    free straight line is always the shortest path.

    Args:
        simulation: The simulation, whose static objects are the obstacles.
        world: Index of one of its worlds.
    """

    def __init__(self, simulation: Simulation, world: int = 0) -> None:
        first = world * simulation.objects
        records = simulation.scenario.objects
        standing = [first + int(i) for i in np.flatnonzero(kinds_of(records) == STATIC) if records[i].static]
        parts = [part for row in standing for part in outline(simulation.state, row, world_frame=True).core()]
        self._bounds = simulation.scenario.world.bounds
        self._empty = not parts
        self._parts = parts
        self._terrains: dict[tuple[float, float, float, float], core.Terrain] = {}
        self._known: dict[Any, Floats | None] = {}

    def path(self, start: Floats, goal: Floats, radius: float, *, coarse: bool = False) -> Floats | None:
        """Find the shortest path of a disc.

        Args:
            start: (2,) start [m].
            goal: (2,) goal [m].
            radius: Radius of the disc [m].
            coarse: Search on cells four times as large first, which is much faster; on fine cells if that fails.

        Returns:
            (K, 2) corners of the path from start to goal [m]; None if there is no path.
        """
        line = np.array([start[:2], goal[:2]], dtype=np.float64)
        if self._empty:
            return line
        key = (line.tobytes(), radius, coarse)
        if key not in self._known:
            size = max(radius - _SLACK_M, _MIN_RADIUS_M)
            coarse_path = self._search(line, size, _COARSE_FACTOR) if coarse else None
            self._known[key] = self._search(line, size) if coarse_path is None else coarse_path
        return self._known[key]

    def length(self, start: Floats, goal: Floats, radius: float, *, coarse: bool = False) -> float:
        """Length of :meth:`path` [m]; NaN if there is no path."""
        way = self.path(start, goal, radius, coarse=coarse)
        return math.nan if way is None else float(np.linalg.norm(np.diff(way, axis=0), axis=1).sum())

    def _search(self, line: Floats, radius: float, larger: float = 1.0) -> Floats | None:
        x0, y0, x1, y1 = self._bounds
        low, high = line.min(axis=0) - radius, line.max(axis=0) + radius
        bounds = (min(x0, low[0]), min(y0, low[1]), max(x1, high[0]), max(y1, high[1]))
        terrain = self._terrains.get(bounds)
        if terrain is None:
            terrain = self._terrains[bounds] = core.Terrain(bounds, [(self._parts, (0.0, 0.0, 0.0))])
        body = [core.Circle(radius=radius, center=(0.0, 0.0))]
        start, goal = (float(line[0, 0]), float(line[0, 1])), (float(line[1, 0]), float(line[1, 1]))
        if terrain.clear(body, 0.0, start, goal):
            return line
        width, height = bounds[2] - bounds[0], bounds[3] - bounds[1]
        size = larger * max(min(_MAX_CELL_M, radius / 2), math.sqrt(width * height / _MAX_CELLS))
        nx, ny = max(1, round(width / size)), max(1, round(height / size))
        path, *_ = terrain.plan(
            core.AstarOptions(resolution=0.0),
            parts=body,
            heading=0.0,
            start=start,
            goal=goal,
            cells=((bounds[0], bounds[1]), (width / nx, height / ny), nx, ny),
            key=(0, 0, 0),
            object=0,
            first_draw=0,
            smooth=True,
        )
        return None if path is None else np.asarray(path)


def inscribed_radius(simulation: Simulation, row: int) -> float:
    """Radius [m] of the largest disc about the origin of a body inside one of its parts; 0 if the origin is outside."""
    best = 0.0
    for part in outline(simulation.state, row).parts:
        if isinstance(part, Circle):
            best = max(best, part.radius - math.hypot(*part.center))
        elif isinstance(part, Polygon):
            best = max(best, _depth_of_origin(part.corners))
    return best


def _depth_of_origin(corners: Floats) -> float:
    """Distance of the origin to the boundary of a polygon [m]; 0 outside the polygon."""
    a, b = corners, np.roll(corners, -1, axis=0)
    along = b - a
    length2 = np.maximum((along**2).sum(axis=1), 1e-300)
    at = np.clip(-(a * along).sum(axis=1) / length2, 0.0, 1.0)
    gap = float(np.linalg.norm(a + along * at[:, None], axis=1).min())
    crossed = (a[:, 1] > 0) != (b[:, 1] > 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        where = a[:, 0] - a[:, 1] * along[:, 0] / along[:, 1]
    return gap if np.count_nonzero(crossed & (where > 0)) % 2 else 0.0
