"""The narrowest passages on the ways of robots: the free gap between what stands left and right of each way."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.navigation.outlines import placed_parts
from irsim.results.scene import ScenePassage
from irsim.scenario.resolve.body_size import has_fixed_shape, inner_disc, parts_of
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.validation.feasibility.clearance_grid import cells_over
from irsim.validation.feasibility.gaps import outlines_of
from irsim.validation.feasibility.scenes import FAR

__all__ = ["find_passages"]

_MAX_LEGS = 40
"""Number of ways from one goal to the next that are searched."""
_MAX_CELLS = 150_000
"""Number of cells over which ways are searched."""
_CELLS_PER_RADIUS = 4
"""Cells along the radius of the smallest robot, unless that takes too many cells."""
_COARSE_CELL = 0.8
"""Cells larger than this share of the radius of a robot miss thin walls, so its ways are not searched."""
_MAX_CORNERS = 40_000
"""Number of corners of obstacles up to which passages are measured."""
_REACHES = (0.75, 1.0, 1.5, 2.0, 3.0, 4.0)
"""Distances from the way, in widths of the robot, up to which obstacles count; the first with both sides is used."""
_WIDE = 5.0
"""Passages wider than this many widths of the robot are left out."""
_TOLERANCE_M = 0.005
"""Places and widths that differ by less are the same passage [m]."""

Point = tuple[float, float]


def find_passages(scenario: ResolvedScenario, state: core.State, world: int) -> list[ScenePassage]:
    """Find the narrowest passage on the shortest way of each robot to each of its goals.

    A passage is the least distance between what stands left and what stands right of a way. Passages wider than a
    few robots are left out. Equal passages of the same robots are one, as are those of several robots at one place.

    Args:
        scenario: The scenario.
        state: Worlds at their starts.
        world: Index of the world.
    """
    first = world * len(scenario.objects)
    standing = [k for k, record in enumerate(scenario.objects) if record.static and not record.unobstructed]
    parts = [part for k in standing for part in placed_parts(state, first + k, world_frame=True)]
    robots = [
        (k, width)
        for k, record in enumerate(scenario.objects)
        if record.role == "robot" and not record.static and not record.wander and has_fixed_shape(record.shape)
        if (width := 2 * inner_disc(parts_of(record.shape))[2]) > 0
    ]
    if not parts or not robots:
        return []
    obstacles = _outlines(parts)
    if obstacles is None:
        return []
    ways = _Ways(scenario.world.bounds, parts, min(width for _, width in robots) / 2)
    found: list[ScenePassage] = []
    legs = 0
    for k, width in robots:
        own: list[tuple[float, Point]] = []
        here = _point(state.pose[first + k])
        for goal in state.goals(first + k):
            there, legs = _point(goal), legs + 1
            line = (
                ways.shortest(here, there, width / 2, scenario.objects[k].goal_threshold) if legs <= _MAX_LEGS else None
            )
            passage = None if line is None else _narrowest(line, obstacles, width)
            if passage is not None:
                own.append(passage)
            here = there
        least = min((gap for gap, _ in own), default=0.0)
        for gap, place in own:
            if gap < least + _TOLERANCE_M:
                _add(found, scenario.objects[k].name, width, gap, place)
    return _joined(sorted(found, key=lambda passage: passage.gap - passage.width))


def _add(found: list[ScenePassage], name: str, width: float, gap: float, place: Point) -> None:
    """Add a passage of a robot, or the robot to the same passage of others as wide as itself."""
    for passage in found:
        near = math.dist(passage.places[0], place) < gap
        if near and abs(passage.gap - gap) + abs(passage.width - width) < _TOLERANCE_M:
            if name not in passage.names:
                passage.names.append(name)
            return
    found.append(ScenePassage(names=[name], width=width, gap=gap, places=[place]))


def _joined(passages: list[ScenePassage]) -> list[ScenePassage]:
    """Join the passages of the same robots that are equally wide."""
    joined: list[ScenePassage] = []
    for passage in passages:
        same = [one for one in joined if one.names == passage.names and abs(one.gap - passage.gap) < _TOLERANCE_M]
        if same:
            same[0].places.extend(passage.places)
        else:
            joined.append(passage)
    return joined


class _Ways:
    """Shortest ways of discs between obstacles.

    Args:
        bounds: Extent of the world: left, bottom, right, top [m].
        parts: Obstacles, world frame.
        radius: Radius of the smallest disc [m].
    """

    def __init__(self, bounds: tuple[float, float, float, float], parts: Sequence[Any], radius: float) -> None:
        cells = cells_over(bounds, radius / _CELLS_PER_RADIUS, _MAX_CELLS)
        self._bounds, self._size = bounds, max(cells[1])
        self._clearance = core.Clearance(core.Terrain(FAR, [(list(parts), [0.0, 0.0, 0.0])]), cells)

    def shortest(self, start: Point, goal: Point, radius: float, reach: float) -> Floats | None:
        """(K, 2) points of the shortest way of a disc to a goal; None if there is none or cells are too large."""
        x0, y0, x1, y1 = self._bounds
        inside = all(x0 <= x <= x1 and y0 <= y <= y1 for x, y in (start, goal))
        half = self._size * math.sqrt(0.5)
        if not inside or self._size > _COARSE_CELL * radius or math.dist(start, goal) == 0:
            return None
        if self._clearance.widest(start, goal, reach)[0] < radius - half:
            return None
        way = self._clearance.way(start, goal, radius)
        if not len(way):  # a passage hardly wider than the disc, or an end near an obstacle
            way = self._clearance.way(start, goal, radius - half)
        return np.concatenate([[start], way[1:-1], [goal]]) if len(way) else None


def _narrowest(line: Floats, obstacles: Any, width: float) -> tuple[float, Point] | None:
    """The least distance between obstacles left and right of a way, and the middle of that gap; None if it is wide."""
    import shapely

    way = shapely.LineString(line).simplify(width / 16)
    for reach in (width * share for share in _REACHES):
        left, right = (
            shapely.intersection(obstacles, shapely.buffer(way, side * reach, single_sided=True, cap_style="flat"))
            for side in (1, -1)
        )
        if left.is_empty or right.is_empty:
            continue
        (ax, ay), (bx, by) = shapely.get_coordinates(shapely.shortest_line(left, right)).tolist()
        gap = math.dist((ax, ay), (bx, by))
        if gap > 2 * reach:  # they do not face each other
            continue
        measured = (1 - 1 / _CELLS_PER_RADIUS) * width < gap <= _WIDE * width
        return (gap, ((ax + bx) / 2, (ay + by) / 2)) if measured else None
    return None


def _outlines(parts: Sequence[Any]) -> Any:
    """The outlines of obstacles as one geometry; None if they have too many corners."""
    import shapely

    lines: list[Any] = []
    corners = 0
    for points, radius in itertools.chain.from_iterable(outlines_of(part, [0.0, 0.0, 0.0]) for part in parts):
        corners += len(points)
        if corners > _MAX_CORNERS:
            return None
        lines.append(shapely.Point(points[0]).buffer(radius, 32).exterior if radius else shapely.LineString(points))
    return shapely.multilinestrings(lines) if lines else None


def _point(values: Any) -> Point:
    return float(values[0]), float(values[1])
