"""The shortest way round what stands still."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.metrics.roles import STATIC, company_of
from irsim.navigation.outlines import placed_parts

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["Geodesics", "inscribed_radius"]

Floats = NDArray[np.float64]
_FINE = 0.05  # cells at most [m]; half the radius where that is less
_MOST_CELLS = 250_000
_COARSER = 4.0
_SLACK = 1e-3  # the disc is that much smaller than the body, which may touch
_SMALLEST = 0.01  # radius [m]


class Geodesics:
    """Shortest ways of a disc among the static things of one world: any-angle smoothed A* on the inflated map.

    Cells are 0.05 m or half the radius, whichever is less, coarser in worlds of more than 250,000 such cells. The
    straight line is the way where it is free.

    Args:
        simulation: What stands where.
        world: Which of its worlds.
    """

    def __init__(self, simulation: Simulation, world: int = 0) -> None:
        first = world * simulation.objects
        records = simulation.scenario.objects
        standing = [first + int(i) for i in np.flatnonzero(company_of(records) == STATIC) if records[i].static]
        parts = [part for row in standing for part in placed_parts(simulation.state, row, world_frame=True)]
        self._bounds = simulation.scenario.world.bounds
        self._empty = not parts
        self._parts = parts
        self._terrains: dict[tuple[float, float, float, float], core.Terrain] = {}
        self._known: dict[Any, Floats | None] = {}

    def way(self, start: Floats, goal: Floats, radius: float, *, coarse: bool = False) -> Floats | None:
        """Shortest way of a disc.

        Args:
            start: (2,) [m].
            goal: (2,) [m].
            radius: Of the disc [m].
            coarse: On cells four times as large, if that finds one; much faster.

        Returns:
            (K, 2) corners from start to goal [m]; None if there is no way.
        """
        line = np.array([start[:2], goal[:2]], dtype=np.float64)
        if self._empty:
            return line
        key = (line.tobytes(), radius, coarse)
        if key not in self._known:
            size = max(radius - _SLACK, _SMALLEST)
            found = self._searched(line, size, _COARSER) if coarse else None
            self._known[key] = self._searched(line, size) if found is None else found
        return self._known[key]

    def length(self, start: Floats, goal: Floats, radius: float, *, coarse: bool = False) -> float:
        """Length of :meth:`way` [m]; NaN if there is none."""
        way = self.way(start, goal, radius, coarse=coarse)
        return math.nan if way is None else float(np.linalg.norm(np.diff(way, axis=0), axis=1).sum())

    def _searched(self, line: Floats, radius: float, larger: float = 1.0) -> Floats | None:
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
        size = larger * max(min(_FINE, radius / 2), math.sqrt(width * height / _MOST_CELLS))
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
    """Radius [m] of the largest disc about the origin of a body that one of its parts contains; 0 without any."""
    state, best = simulation.state, 0.0
    for part, kind in enumerate(state.parts(row)):
        if kind == "circle":
            x, y, radius = state.circle(row, part, False)
            best = max(best, radius - math.hypot(x, y))
        elif kind == "polygon":
            best = max(best, _inside(np.asarray(state.vertices(row, part, False))))
    return best


def _inside(corners: Floats) -> float:
    """How deep the origin is inside a polygon; 0 outside."""
    a, b = corners, np.roll(corners, -1, axis=0)
    along = b - a
    length2 = np.maximum((along**2).sum(axis=1), 1e-300)
    at = np.clip(-(a * along).sum(axis=1) / length2, 0.0, 1.0)
    gap = float(np.linalg.norm(a + along * at[:, None], axis=1).min())
    crossed = (a[:, 1] > 0) != (b[:, 1] > 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        where = a[:, 0] - a[:, 1] * along[:, 0] / along[:, 1]
    return gap if np.count_nonzero(crossed & (where > 0)) % 2 else 0.0
