"""Geometry by brute force: outlines as lists of corners, distances by going through all sides, paths over cells."""

from __future__ import annotations

import itertools
import math
from collections import deque
from collections.abc import Iterator
from typing import Any

__all__ = ["Thing", "blocked", "contains", "distance_between", "gets_there", "segments"]

Point = tuple[float, float]
_MAX_CELLS = 6000
"""Number of cells at most."""


class Thing:
    """One object, known from the public interface of the simulator alone.

    Attributes:
        view: The object of the environment.
        entry: Its entry in the YAML.
        section: ``robot`` or ``obstacle``.
        radius: Radius of a disc; None for other shapes.
    """

    def __init__(self, view: Any, entry: dict[str, Any], section: str) -> None:
        self.view, self.entry, self.section = view, entry, section
        self.radius = float(view.radius) if view.shape == "circle" else None

    @property
    def at(self) -> tuple[float, float, float]:
        """Present x, y, heading."""
        state = self.view.state
        return float(state[0, 0]), float(state[1, 0]), float(state[2, 0])

    @property
    def corners(self) -> list[Point]:
        """Present corners of its outline; of a disc its middle."""
        if self.radius is not None:
            return [self.at[:2]]
        vertices = self.view.vertices
        return [(float(x), float(y)) for x, y in vertices.T]

    @property
    def is_line(self) -> bool:
        """Whether it has no inside."""
        return bool(self.view.shape == "linestring")

    @property
    def middle(self) -> Point:
        """Where it is: the middle of a static object, else its position."""
        if self.radius is not None or not self.view.static:
            return self.at[:2]
        if self.is_line:
            lengths = [math.dist(a, b) for a, b in segments(self)]
            pieces = list(zip(segments(self), lengths, strict=True))
            total = sum(lengths)
            return (
                sum((a[0] + b[0]) / 2 * length for (a, b), length in pieces) / total,
                sum((a[1] + b[1]) / 2 * length for (a, b), length in pieces) / total,
            )
        area = x = y = 0.0
        for (x0, y0), (x1, y1) in segments(self):
            cross = x0 * y1 - x1 * y0
            area, x, y = area + cross / 2, x + (x0 + x1) * cross / 6, y + (y0 + y1) * cross / 6
        return x / area, y / area


def segments(thing: Thing) -> list[tuple[Point, Point]]:
    """The sides of an outline."""
    corners = thing.corners
    if thing.is_line:
        return list(itertools.pairwise(corners))
    if corners[0] == corners[-1]:
        corners = corners[:-1]
    return list(zip(corners, [*corners[1:], corners[0]], strict=True))


def contains(thing: Thing, point: Point) -> bool:
    """Whether a point lies inside an outline: an odd number of its sides is to the right."""
    if thing.radius is not None:
        return math.dist(thing.at[:2], point) <= thing.radius
    if thing.is_line:
        return False
    odd = False
    for (x0, y0), (x1, y1) in segments(thing):
        if (y0 > point[1]) != (y1 > point[1]) and point[0] < x0 + (point[1] - y0) * (x1 - x0) / (y1 - y0):
            odd = not odd
    return odd


def _to_segment(point: Point, a: Point, b: Point) -> float:
    dx, dy = b[0] - a[0], b[1] - a[1]
    square = dx * dx + dy * dy
    t = 0.0 if square == 0 else max(0.0, min(1.0, ((point[0] - a[0]) * dx + (point[1] - a[1]) * dy) / square))
    return math.dist(point, (a[0] + t * dx, a[1] + t * dy))


def _cross(a: Point, b: Point, c: Point, d: Point) -> bool:
    """Whether two segments cross in one point inside of both."""

    def side(p: Point, q: Point, r: Point) -> float:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0


def to_point(thing: Thing, point: Point) -> float:
    """Distance of a point from the edge of a thing; 0 inside [m]."""
    if thing.radius is not None:
        return max(0.0, math.dist(thing.at[:2], point) - thing.radius)
    if contains(thing, point):
        return 0.0
    return min(_to_segment(point, a, b) for a, b in segments(thing))


def distance_between(a: Thing, b: Thing) -> float:
    """Distance from edge to edge [m]; negative for discs that overlap, 0 for other shapes that do."""
    if a.radius is not None and b.radius is not None:
        return math.dist(a.at[:2], b.at[:2]) - a.radius - b.radius
    if a.radius is not None:
        return to_point(b, a.at[:2]) - a.radius
    if b.radius is not None:
        return distance_between(b, a)
    if any(_cross(*one, *other) for one in segments(a) for other in segments(b)):
        return 0.0
    if contains(a, b.corners[0]) or contains(b, a.corners[0]):
        return 0.0
    return min(
        min(_to_segment(p, *side) for p, side in _pairs(a, b)),
        min(_to_segment(p, *side) for p, side in _pairs(b, a)),
    )


def _pairs(a: Thing, b: Thing) -> Iterator[tuple[Point, tuple[Point, Point]]]:
    return itertools.product(a.corners, segments(b))


def blocked(thing: Thing, a: Point, b: Point) -> bool:
    """Whether a straight line between two points touches a thing."""
    if thing.radius is not None:
        return _to_segment(thing.at[:2], a, b) <= thing.radius
    return contains(thing, a) or contains(thing, b) or any(_cross(a, b, *side) for side in segments(thing))


def gets_there(
    solids: list[Thing], bounds: tuple[float, float, float, float], start: Point, goal: Point, radius: float
) -> bool:
    """Whether a disc gets from one place to another over cells whose middle is free for it.

    Args:
        solids: The obstacles.
        bounds: x0, y0, x1, y1 of the world [m].
        start, goal: Both ends [m].
        radius: Radius of the disc [m].
    """
    if any(to_point(solid, place) < radius for solid in solids for place in (start, goal)):
        return False
    x0, y0, x1, y1 = bounds
    size = max(radius / 3, math.sqrt((x1 - x0) * (y1 - y0) / _MAX_CELLS))
    nx, ny = math.ceil((x1 - x0) / size), math.ceil((y1 - y0) / size)

    def cell(point: Point) -> tuple[int, int]:
        return min(nx - 1, max(0, int((point[0] - x0) / size))), min(ny - 1, max(0, int((point[1] - y0) / size)))

    free: dict[tuple[int, int], bool] = {}

    def is_free(at: tuple[int, int]) -> bool:
        if at not in free:
            middle = (x0 + (at[0] + 0.5) * size, y0 + (at[1] + 0.5) * size)
            free[at] = all(to_point(solid, middle) >= radius for solid in solids)
        return free[at]

    end, seen, queue = cell(goal), {cell(start)}, deque([cell(start)])
    while queue:
        i, j = queue.popleft()
        if (i, j) == end:
            return True
        for step in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            if 0 <= step[0] < nx and 0 <= step[1] < ny and step not in seen and (step == end or is_free(step)):
                seen.add(step)
                queue.append(step)
    return False
