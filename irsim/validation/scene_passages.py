"""The narrowest passages on the ways of robots: the free gap between what stands left and right of each way."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.common.outline import outline
from irsim.episodes.planned_routes import planned_routes
from irsim.results.picture import ScenePassage
from irsim.scenario.model.zones import Zone
from irsim.scenario.resolve.body_size import has_fixed_shape, inner_disc
from irsim.scenario.resolve.kernels import parts_of
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario
from irsim.validation.feasibility.clearance_grid import cells_over
from irsim.validation.feasibility.gaps import outlines_of
from irsim.validation.feasibility.scenes import FAR

__all__ = ["Places", "find_passages", "passages_of_legs"]

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
_MAX_EQUAL = 4
"""Number of places on one leg that are listed if they are equally narrow."""
_TOLERANCE_M = 0.005
"""Places and widths that differ by less are the same passage [m]."""

Point = tuple[float, float]
Thing = tuple[Sequence[Any], Sequence[float]]
"""Parts of a body, and its pose."""


@dataclass(frozen=True)
class Places:
    """Where the objects of a scenario are at the start.

    Attributes:
        seed: Seed of random shapes and maps.
        pose: Object id -> x, y [m] and heading [rad].
        goals: Object id -> goals to visit.
        things: Parts and pose of everything that stands and is solid.
    """

    seed: int
    pose: Mapping[int, Sequence[float]]
    goals: Mapping[int, Sequence[Sequence[float]]]
    things: Sequence[Thing]


def find_passages(scenario: ResolvedScenario, state: core.State, world: int, seed: int) -> list[ScenePassage]:
    """Find the narrowest passages on the way of each robot to each of its goals.

    A passage is the least distance between what stands left and what stands right of a way. Passages wider than a
    few robots are left out. Equal passages of the same robots are one, and so are passages of robots at one place.

    Args:
        scenario: The scenario.
        state: Worlds at their starts.
        world: Index of the world.
        seed: Seed of the world.
    """
    first = world * len(scenario.objects)
    records = scenario.objects
    standing = [k for k, record in enumerate(records) if record.static and not record.unobstructed]
    parts = [part for k in standing for part in outline(state, first + k, world_frame=True).core()]
    places = Places(
        seed,
        {record.id: state.pose[first + k].tolist() for k, record in enumerate(records)},
        {record.id: [[float(x) for x in goal] for goal in state.goals(first + k)] for k, record in enumerate(records)},
        [(parts, (0.0, 0.0, 0.0))] if parts else [],
    )
    narrow: list[ScenePassage] = []
    legs = passages_of_legs(scenario, places)
    for record in records:
        own = [passage for (key, _), passages in legs.items() if key == record.id for passage in passages]
        least = min((gap for gap, _ in own), default=0.0)
        for gap, place in own:
            if gap < least + _TOLERANCE_M:
                _add(narrow, record.name, _width(record), gap, place)
    return _joined(sorted(narrow, key=lambda passage: passage.gap - passage.width))


def passages_of_legs(
    scenario: ResolvedScenario, places: Places, only: int | None = None
) -> dict[tuple[int, int], list[tuple[float, Point]]]:
    """Find the narrowest passages on each leg of the ways of robots.

    The way of a robot under `follow` is the route that it plans and drives; other robots take the shortest one.
    Zones that a robot keeps out of (`avoid`) are as solid as obstacles.

    Args:
        scenario: The scenario.
        places: Where the objects are.
        only: Id of the robot; by default all robots.

    Returns:
        (object id, number of the leg) -> width [m] and middle of the narrowest passage and of equally narrow ones; legs
        without a narrow passage are missing.
    """
    robots = [r for r in scenario.objects if _is_measured(r) and only in (None, r.id)]
    asked = {record.id: places.goals.get(record.id, []) for record in robots}
    solid = any(places.things) or any(_avoided(scenario, record) for record in robots)
    if not solid or not any(asked.values()):
        return {}
    routes = planned_routes(scenario, places.seed, places.pose, asked)
    grounds: dict[tuple[str, ...], _Ground | None] = {}
    by_leg: dict[tuple[int, int], list[tuple[float, Point]]] = {}
    legs = 0
    for record in robots:
        width, here = _width(record), _point(places.pose[record.id])
        closed = _avoided(scenario, record)
        key = tuple(zone.name for zone in closed)
        if key not in grounds:
            things = [*places.things, *(([_part_of(zone)], (0.0, 0.0, 0.0)) for zone in closed)]
            grounds[key] = _ground(scenario.world.bounds, things, min(map(_width, robots)) / 2)
        ground, mine = grounds[key], routes.get(record.id)
        for leg, goal in enumerate(asked[record.id]):
            there, legs = _point(goal), legs + 1
            if ground is None or legs > _MAX_LEGS or (mine is not None and (leg >= len(mine) or mine[leg] is None)):
                break
            line = ground.shortest(here, there, width / 2, record.goal_threshold) if mine is None else mine[leg]
            passages = [] if line is None or len(line) < 2 else _narrowest_ones(line, ground.outlines, width)
            if passages:
                by_leg[record.id, leg] = passages
            here = there
    return by_leg


def _is_measured(record: ObjectRecord) -> bool:
    """Whether passages on the way of an object are told: of robots that move and have a fixed shape."""
    moves = record.role == "robot" and not record.static and not record.wander
    return moves and has_fixed_shape(record.shape) and _width(record) > 0


def _width(record: ObjectRecord) -> float:
    """Diameter of the largest disc in the body of an object [m]."""
    return 2 * inner_disc(parts_of(record.shape))[2]


def _avoided(scenario: ResolvedScenario, record: ObjectRecord) -> list[Zone]:
    """The areas that an object keeps out of."""
    names = set(getattr(record.behavior, "avoid", ()))
    return [zone for zone in scenario.world.zones if zone.name in names and not zone.is_line]


def _part_of(zone: Zone) -> Any:
    """A zone as a part in the world frame."""
    if zone.circle is not None:
        return core.Circle(radius=zone.circle.radius, center=zone.circle.center)
    return core.Polygon(vertices=zone.points)


def _add(passages: list[ScenePassage], name: str, width: float, gap: float, place: Point) -> None:
    """Add a passage of a robot, or add the robot to that passage of equally wide robots."""
    for passage in passages:
        near = math.dist(passage.places[0], place) < gap
        if near and abs(passage.gap - gap) + abs(passage.width - width) < _TOLERANCE_M:
            if name not in passage.names:
                passage.names.append(name)
            return
    passages.append(ScenePassage(names=[name], width=width, gap=gap, places=[place]))


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


class _Ground:
    """Standing obstacles, and shortest ways of discs between them.

    Args:
        bounds: Extent of the world: left, bottom, right, top [m].
        things: Parts and poses of everything solid.
        outlines: Their outlines.
        radius: Radius of the smallest disc [m].
    """

    def __init__(
        self, bounds: tuple[float, float, float, float], things: Sequence[Thing], outlines: Any, radius: float
    ) -> None:
        self.outlines = outlines
        self._bounds, self._cells = bounds, cells_over(bounds, radius / _CELLS_PER_RADIUS, _MAX_CELLS)
        self._things, self._size = things, max(self._cells[1])

    @cached_property
    def _clearance(self) -> core.Clearance:
        terrain = core.Terrain(FAR, [(list(parts), list(pose)) for parts, pose in self._things])
        return core.Clearance(terrain, self._cells)

    def shortest(self, start: Point, goal: Point, radius: float, reach: float) -> Floats | None:
        """(K, 2) points of the shortest way of a disc to a goal; None without a way, or if cells are too large."""
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


def _narrowest_ones(line: Floats, obstacles: Any, width: float) -> list[tuple[float, Point]]:
    """The narrowest passage on a way, and further ones that are as narrow."""
    pieces: list[Any] = [shapely.LineString(line).simplify(width / 16)]
    passages: list[tuple[float, Point]] = []
    while pieces and len(passages) < _MAX_EQUAL:
        piece = pieces.pop(0)
        passage = _narrowest(piece, obstacles, width)
        if passage is None or (passages and passage[0] > passages[0][0] + _TOLERANCE_M):
            continue
        passages.append(passage)
        rest = shapely.difference(piece, shapely.Point(passage[1]).buffer(max(passage[0], width)))
        pieces += [part for part in shapely.get_parts(rest) if part.length > width]
    least = min((gap for gap, _ in passages), default=0.0)
    return [passage for passage in passages if passage[0] < least + _TOLERANCE_M]


def _narrowest(way: Any, obstacles: Any, width: float) -> tuple[float, Point] | None:
    """The least distance between obstacles left and right of a way, and the middle of that gap; None if it is wide."""
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


def _ground(bounds: tuple[float, float, float, float], things: Sequence[Thing], radius: float) -> _Ground | None:
    """The standing obstacles; None without any, or with too many corners."""
    outlines = _outlines(things)
    return None if outlines is None else _Ground(bounds, things, outlines, radius)


def _outlines(things: Sequence[Thing]) -> Any:
    """The outlines of obstacles as one geometry; None without any, and if they have too many corners."""
    lines: list[Any] = []
    corners = 0
    placed = ((part, list(pose)) for parts, pose in things for part in parts)
    for points, radius in itertools.chain.from_iterable(outlines_of(part, pose) for part, pose in placed):
        corners += len(points)
        if corners > _MAX_CORNERS:
            return None
        lines.append(shapely.Point(points[0]).buffer(radius, 32).exterior if radius else shapely.LineString(points))
    return shapely.multilinestrings(lines) if lines else None


def _point(values: Any) -> Point:
    return float(values[0]), float(values[1])
