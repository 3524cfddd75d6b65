"""The clearance map: distance to the nearest static obstacle, which the snapshot overlay ``clearance`` draws."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Any

import numpy as np
from contourpy import FillType, LineType, contour_generator

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.common.outline import Polygon, outline
from irsim.common.text import metres
from irsim.graphics.scene.scene import Bounds, Label, Line, Mark, Region, Scene, Stroke
from irsim.navigation.geodesic import inscribed_radius
from irsim.simulation.roles import HUMAN, STATIC, kinds_of

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["FreeSpace", "draw_clearance", "smallest_robot"]

MAX_CELLS = 120_000
"""Largest number of cells."""
_TOLERANCE_M = 1e-4
"""Accuracy of an exact distance [m]."""
_MARGIN_SHARE = 0.25
"""Obstacles outside the picture count up to this distance from its edge, as a share of its longer side."""
_CELLS_PER_RADIUS = 6
"""Number of cells per radius of the smallest robot, if that does not give too many cells."""
_LINE_DISTANCES_M = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
"""Distances [m] at which lines can be drawn; those below the radius of the smallest robot are not used."""
MIN_LINE_RATIO = 1.4
"""A line is drawn only if its distance is at least this many times the distance of the previous line."""
MAX_LINES = 3
"""Largest number of distances at which lines are drawn."""
MAX_LABEL_CANDIDATES = 60
"""Number of points of a line that are tried as the position of its label."""
MIN_EDGE_SHARE = 0.05
"""Smallest distance of a label from the edge of the picture, as a share of the longer side of the picture."""
MAX_EDGE_SHARE = 0.25
"""The same for very flat pictures, as a share of the shorter side."""
MAX_EDGE_POINTS = 100
"""Number of points on the outline of a body, besides its corners, at which its distance is measured at most."""
MAX_INNER_POINTS = 30
"""Number of points inside it, so that obstacles inside the outline count."""
_TOUCHES = "touches"
"""Label of the area in which a footprint touches an obstacle."""
_UNREACHABLE_COLOR = "#e8590c"
_LINE_COLOR = "#1c7ed6"
_TEXT_COLOR = "#1864ab"
_FILL_ALPHA = 0.22
_LINE_ALPHA = 0.55
_ZORDER = 0.5
_TEXT_ZORDER = 9.0
_TEXT_SIZE_PT = 7.5
_NO_OBJECT = -1000
"""Object id of marks and labels that belong to no object; further labels count down from here."""


class FreeSpace:
    """Distances to the nearest static obstacle, standing people included, over a rectangle.

    Args:
        simulation: The simulation.
        world: Index of the world.
        box: Left, bottom, right, top [m].
        radius: Radius of the smallest robot [m]; cells are several times smaller, unless that gives too many.

    Attributes:
        half_diagonal: Half the diagonal of a cell [m].
    """

    def __init__(self, simulation: Simulation, world: int, box: Bounds, radius: float) -> None:
        first, records = world * simulation.objects, simulation.scenario.objects
        kinds = kinds_of(records)
        static = [i for i, kind in enumerate(kinds.tolist()) if kind in (STATIC, HUMAN) and records[i].static]
        parts = [part for i in static for part in outline(simulation.state, first + i, world_frame=True).core()]
        width, height = box[2] - box[0], box[3] - box[1]
        size = max(math.sqrt(width * height / MAX_CELLS), radius / _CELLS_PER_RADIUS)
        nx, ny = max(2, math.ceil(width / size)), max(2, math.ceil(height / size))
        self._box, self._cell = box, (width / nx, height / ny)
        self.half_diagonal = math.hypot(*self._cell) / 2
        self._terrain = core.Terrain((-1e8, -1e8, 1e8, 1e8), [(parts, (0.0, 0.0, 0.0))] if parts else [])
        self._clearance = core.Clearance(self._terrain, (box[:2], self._cell, nx, ny))
        self._distance: Floats | None = None

    @property
    def distance(self) -> Floats:
        """(nx, ny) distances at the centres of the cells [m]."""
        if self._distance is None:
            self._distance = np.asarray(self._clearance.distance, dtype=np.float64)
        return self._distance

    @property
    def cell_centers(self) -> tuple[Floats, Floats]:
        """(nx,) and (ny,) coordinates of the centres of the cells [m]."""
        nx, ny = self.distance.shape
        x = self._box[0] + (np.arange(nx) + 0.5) * self._cell[0]
        y = self._box[1] + (np.arange(ny) + 0.5) * self._cell[1]
        return np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)

    def distance_at(self, points: Floats) -> Floats:
        """Return the (K,) distances of the cells that contain (K, 2) points [m]."""
        cells = ((points - self._box[:2]) / self._cell).astype(int)
        i, j = (np.clip(cells[:, axis], 0, size - 1) for axis, size in enumerate(self.distance.shape))
        values: Floats = self.distance[i, j]
        return values

    def exact_distance(self, point: tuple[float, float]) -> float:
        """Return the distance at a point [m], accurate to 0.1 mm; infinity in a world without static obstacles."""
        low, high = 0.0, float(self.distance_at(np.array([point]))[0]) + 2 * self.half_diagonal
        if not math.isfinite(high):
            return high
        while high - low > _TOLERANCE_M:
            radius = (low + high) / 2
            touches = self._terrain.collides([core.Circle(radius=radius, center=(0.0, 0.0))], (*point, 0.0))
            low, high = (low, radius) if touches else (radius, high)
        return low

    def path(self, start: Floats, goal: Floats, radius: float, reach: float) -> Floats | None:
        """Return the (K, 2) points of a path of a disc to within ``reach`` of a goal; None without such a path."""
        first, target = (float(start[0]), float(start[1])), (float(goal[0]), float(goal[1]))
        if self._clearance.widest(first, target, reach)[0] < radius - self.half_diagonal:
            return None
        last = target if self.exact_distance(target) >= radius else self._clearance.climb(target, reach)
        min_distance = min(radius, float(self.distance_at(np.array([first, last])).min())) - self.half_diagonal
        points = np.asarray(self._clearance.way(first, last, min_distance))
        return np.concatenate([[first], points[1:-1], [last]]) if len(points) else None


def smallest_robot(simulation: Simulation, world: int = 0) -> int | None:
    """Return the row of the robot with the smallest inscribed disc, which the map is about; None without robots."""
    rows = (world * simulation.objects + np.flatnonzero(simulation.robots)).tolist()
    sizes = {row: inscribed_radius(simulation, row) for row in rows}
    return min((row for row in rows if sizes[row] > 0), key=lambda row: sizes[row], default=None)


def draw_clearance(
    scene: Scene, simulation: Simulation, world: int = 0, *, path: tuple[Polygon, Floats] | None = None
) -> None:
    """Add the clearance map to a scene: where the middle of the smallest robot cannot be, and lines of equal distance.

    The lines have the distance of the middle of the robot to obstacles. With a path they have the distance of its body,
    oriented as on the nearest point of the path.

    Args:
        scene: The scene; its extent is the area that the picture shows.
        simulation: The simulation that the scene shows.
        world: Index of the world.
        path: Body of the smallest robot, and its (P, 3) poses x, y [m] and heading [rad] along its path, if it is not
            round and has one.
    """
    x0, x1, y0, y1 = scene.extent
    row = smallest_robot(simulation, world)
    radius = 0.0 if row is None else inscribed_radius(simulation, row)
    margin = _MARGIN_SHARE * max(x1 - x0, y1 - y0)
    box = x0 - margin, y0 - margin, x1 + margin, y1 + margin
    space = FreeSpace(simulation, world, box, max(radius, 0.02))
    distance = space.distance
    if not math.isfinite(float(distance.min())):
        return
    x, y = space.cell_centers
    if path is not None:
        distance, radius = _body_distance(space, *path), space.half_diagonal
    inside = (x[:, None] > x0) & (x[:, None] < x1) & (y > y0) & (y < y1)
    max_distance = float(distance[inside].max())
    levels: Any = contour_generator(x, y, distance.T, fill_type=FillType.OuterOffset, line_type=LineType.Separate)
    if radius > 0:
        points, offsets = levels.filled(-1.0, radius)
        for corners, starts in zip(points, offsets, strict=True):
            rings = [np.asarray(corners[a:b]) for a, b in itertools.pairwise(starts)]
            stroke, region = Stroke(_UNREACHABLE_COLOR, 0.8), Region(rings)
            scene.marks.append(Mark(_NO_OBJECT, "field", region, _UNREACHABLE_COLOR, stroke, _FILL_ALPHA, _ZORDER))
        text = metres(radius) if path is None else _TOUCHES
        _label_line(scene, text, levels.lines(radius), _UNREACHABLE_COLOR)
    shown, last = 0, radius
    for level in _LINE_DISTANCES_M:
        if last * MIN_LINE_RATIO < level < max_distance and shown < MAX_LINES:
            lines = levels.lines(level)
            for line in lines:
                stroke = Stroke(_LINE_COLOR, 0.8)
                scene.marks.append(Mark(_NO_OBJECT, "field", Line(line), None, stroke, _LINE_ALPHA, _ZORDER))
            _label_line(scene, metres(level), lines, _TEXT_COLOR)
            shown, last = shown + 1, level


def _body_distance(space: FreeSpace, body: Polygon, poses: Floats) -> Floats:
    """(nx, ny) distance of a body at each cell to obstacles [m], pointing as on the nearest part of its path."""
    import shapely

    x, y = space.cell_centers
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    places = np.asarray(shapely.points(poses[:, :2]), dtype=object)
    nearest = shapely.STRtree(places).nearest(shapely.points(points))
    cos, sin = np.cos(poses[nearest, 2]), np.sin(poses[nearest, 2])
    least = np.full(len(points), math.inf)
    for bx, by in _samples(body.corners, 2 * space.half_diagonal):
        least = np.minimum(least, space.distance_at(points + np.stack([cos * bx - sin * by, sin * bx + cos * by], 1)))
    return least.reshape(len(x), len(y))


def _samples(outline: Floats, step: float) -> Floats:
    """(K, 2) points on an outline, about ``step`` apart or farther if there would be too many, and some inside [m]."""
    from shapely import MultiPoint, Polygon

    body = Polygon(outline)
    edge = np.asarray(body.exterior.segmentize(max(step, body.length / MAX_EDGE_POINTS)).coords)
    x0, y0, x1, y1 = body.bounds
    apart = math.sqrt((x1 - x0) * (y1 - y0) / MAX_INNER_POINTS)
    grid = MultiPoint([(x, y) for x in np.arange(x0 + apart / 2, x1, apart) for y in np.arange(y0, y1, apart)])
    inner = np.asarray([(p.x, p.y) for p in grid.geoms if body.contains(p)]).reshape(-1, 2)
    return np.concatenate([edge, inner])


def _label_line(scene: Scene, text: str, lines: list[Floats], color: str) -> None:
    """Label lines of one distance at the point that is farthest from other labels and not close to the edge."""
    x0, x1, y0, y1 = scene.extent
    thinned = [line[:: max(1, len(line) // MAX_LABEL_CANDIDATES)] for line in lines]
    points = np.concatenate(thinned) if thinned else np.empty((0, 2))
    inside = np.minimum(
        np.minimum(points[:, 0] - x0, x1 - points[:, 0]), np.minimum(points[:, 1] - y0, y1 - points[:, 1])
    )
    points = points[inside > min(MIN_EDGE_SHARE * max(x1 - x0, y1 - y0), MAX_EDGE_SHARE * min(x1 - x0, y1 - y0))]
    if not len(points):
        return
    taken = np.array([label.anchor for label in scene.labels]).reshape(-1, 2)
    best = 0
    if len(taken):
        best = int(np.hypot(*(points[:, None] - taken[None]).transpose(2, 0, 1)).min(axis=1).argmax())
    number = _NO_OBJECT - sum(label.object <= _NO_OBJECT for label in scene.labels)
    x, y = points[best].tolist()
    scene.labels.append(Label(number, "field", x, y, (x, y), text, color, _TEXT_SIZE_PT, 1.0, _TEXT_ZORDER))
