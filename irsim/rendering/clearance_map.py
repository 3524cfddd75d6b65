"""How far from everything that stands still: what a snapshot's overlay ``clearance`` draws."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Any

import numpy as np
from contourpy import FillType, LineType, contour_generator

import irsim._core as core
from irsim.graphics.scene.scene import Bounds, Floats, Label, Line, Mark, Region, Scene, Stroke
from irsim.metrics.geodesic import inscribed_radius
from irsim.metrics.roles import STATIC, kinds_of
from irsim.navigation.outlines import placed_parts

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["FreeSpace", "draw_clearance"]

_CELLS = 120_000
_EXACT = 1e-4
_BEYOND = 0.25
"""What is so far beyond the edge of the picture counts too, as a share of its longer side."""
_PER_RADIUS = 6
_NICE = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
"""Distances that lines are drawn at, those that are more than the radius [m]."""
_APART = 1.4
"""A line is left out that is not so many times as far off as the one before."""
_MOST_LINES = 3
_TRIED, _EDGE = 60, 0.05
"""Points of a line that are looked at for its label; the least distance from the picture's edge, as a share of it."""
_NO_GO, _LINE, _TEXT = "#e8590c", "#1c7ed6", "#1864ab"
_FILL_ALPHA, _LINE_ALPHA = 0.22, 0.55
_ZORDER, _TEXT_ZORDER = 0.5, 9.0
_SIZE = 7.5
_NOBODY = -1000
"""Labels of nobody count down from here."""


class FreeSpace:
    """Distances to what stands still and is in the way, over a rectangle.

    Args:
        simulation: What stands where.
        world: Which of its worlds.
        box: Left, bottom, right, top [m].
        radius: Cells are a good deal smaller than this, if there are not too many [m].

    Attributes:
        half: Half the diagonal of a cell [m].
    """

    def __init__(self, simulation: Simulation, world: int, box: Bounds, radius: float) -> None:
        first, records = world * simulation.objects, simulation.scenario.objects
        standing = [i for i in np.flatnonzero(kinds_of(records) == STATIC).tolist() if records[i].static]
        parts = [part for i in standing for part in placed_parts(simulation.state, first + i, world_frame=True)]
        width, height = box[2] - box[0], box[3] - box[1]
        size = max(math.sqrt(width * height / _CELLS), radius / _PER_RADIUS)
        nx, ny = max(2, math.ceil(width / size)), max(2, math.ceil(height / size))
        self._box, self._cell = box, (width / nx, height / ny)
        self.half = math.hypot(*self._cell) / 2
        self._terrain = core.Terrain((-1e8, -1e8, 1e8, 1e8), [(parts, (0.0, 0.0, 0.0))] if parts else [])
        self._clearance = core.Clearance(self._terrain, (box[:2], self._cell, nx, ny))
        self._distance: Floats | None = None

    @property
    def distance(self) -> Floats:
        """(nx, ny) distances at the middles of the cells [m]."""
        if self._distance is None:
            self._distance = np.asarray(self._clearance.distance, dtype=np.float64)
        return self._distance

    @property
    def middles(self) -> tuple[Floats, Floats]:
        """(nx,) and (ny,) coordinates of the middles of the cells [m]."""
        nx, ny = self.distance.shape
        x = self._box[0] + (np.arange(nx) + 0.5) * self._cell[0]
        y = self._box[1] + (np.arange(ny) + 0.5) * self._cell[1]
        return np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)

    def at(self, points: Floats) -> Floats:
        """(K,) distances at the cells of (K, 2) points [m]."""
        cells = ((points - self._box[:2]) / self._cell).astype(int)
        i, j = (np.clip(cells[:, axis], 0, size - 1) for axis, size in enumerate(self.distance.shape))
        values: Floats = self.distance[i, j]
        return values

    def exactly_at(self, point: tuple[float, float]) -> float:
        """Distance at a point, to a tenth of a millimetre [m]; infinity where nothing stands."""
        low, high = 0.0, float(self.at(np.array([point]))[0]) + 2 * self.half
        if not math.isfinite(high):
            return high
        while high - low > _EXACT:
            radius = (low + high) / 2
            touches = self._terrain.collides([core.Circle(radius=radius, center=(0.0, 0.0))], (*point, 0.0))
            low, high = (low, radius) if touches else (radius, high)
        return low

    def way(self, start: Floats, goal: Floats, radius: float, reach: float) -> Floats | None:
        """(K, 2) points that a disc passes to get within ``reach`` of a goal; None if there is no way."""
        here, there = (float(start[0]), float(start[1])), (float(goal[0]), float(goal[1]))
        if self._clearance.widest(here, there, reach)[0] < radius - self.half:
            return None
        end = there if self.exactly_at(there) >= radius else self._clearance.climb(there, reach)
        least = min(radius, float(self.at(np.array([here, end])).min())) - self.half
        found = np.asarray(self._clearance.way(here, end, least))
        return np.concatenate([[here], found[1:-1], [end]]) if len(found) else None


def draw_clearance(scene: Scene, simulation: Simulation, world: int = 0) -> None:
    """Add to a scene where the middle of the smallest robot cannot be, and lines at some distances [m].

    Args:
        scene: What to add to; its extent is what the picture shows.
        simulation: Where it is from.
        world: Which of its worlds.
    """
    x0, x1, y0, y1 = scene.extent
    radius = _smallest(simulation, world)
    more = _BEYOND * max(x1 - x0, y1 - y0)
    space = FreeSpace(simulation, world, (x0 - more, y0 - more, x1 + more, y1 + more), max(radius, 0.02))
    distance = space.distance
    if not math.isfinite(float(distance.min())):
        return
    x, y = space.middles
    inside = (x[:, None] > x0) & (x[:, None] < x1) & (y > y0) & (y < y1)
    most = float(distance[inside].max())
    levels: Any = contour_generator(x, y, distance.T, fill_type=FillType.OuterOffset, line_type=LineType.Separate)
    if radius > 0:
        points, offsets = levels.filled(-1.0, radius)
        for corners, starts in zip(points, offsets, strict=True):
            rings = [np.asarray(corners[a:b]) for a, b in itertools.pairwise(starts)]
            stroke = Stroke(_NO_GO, 0.8)
            scene.marks.append(Mark(_NOBODY, "field", Region(rings), _NO_GO, stroke, _FILL_ALPHA, _ZORDER))
        _label(scene, f"{radius:.2g} m", levels.lines(radius), _NO_GO)
    shown, last = 0, radius
    for level in _NICE:
        if last * _APART < level < most and shown < _MOST_LINES:
            lines = levels.lines(level)
            for line in lines:
                stroke = Stroke(_LINE, 0.8)
                scene.marks.append(Mark(_NOBODY, "field", Line(line), None, stroke, _LINE_ALPHA, _ZORDER))
            _label(scene, f"{level:g} m", lines, _TEXT)
            shown, last = shown + 1, level


def _smallest(simulation: Simulation, world: int) -> float:
    """Radius of the smallest robot's inner disc [m]; 0 without robots."""
    rows = world * simulation.objects + np.flatnonzero(simulation.robots)
    found = [inscribed_radius(simulation, int(row)) for row in rows]
    return min((radius for radius in found if radius > 0), default=0.0)


def _label(scene: Scene, text: str, lines: list[Floats], color: str) -> None:
    """Write the distance on one of its lines, where there is most room between other names and the edge."""
    x0, x1, y0, y1 = scene.extent
    points = np.concatenate([line[:: max(1, len(line) // _TRIED)] for line in lines]) if lines else np.empty((0, 2))
    inside = np.minimum(
        np.minimum(points[:, 0] - x0, x1 - points[:, 0]), np.minimum(points[:, 1] - y0, y1 - points[:, 1])
    )
    points = points[inside > _EDGE * max(x1 - x0, y1 - y0)]
    if not len(points):
        return
    taken = np.array([label.anchor for label in scene.labels]).reshape(-1, 2)
    best = 0
    if len(taken):
        best = int(np.hypot(*(points[:, None] - taken[None]).transpose(2, 0, 1)).min(axis=1).argmax())
    number = _NOBODY - sum(label.object <= _NOBODY for label in scene.labels)
    x, y = points[best].tolist()
    scene.labels.append(Label(number, "field", x, y, (x, y), text, color, _SIZE, 1.0, _TEXT_ZORDER))
