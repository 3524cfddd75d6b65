"""Flat walls before which a behavior that plans no way stops: where it is nearest to the goal, there it stays."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import irsim._core as core
from irsim.validation.feasibility.clearance_grid import Point
from irsim.validation.feasibility.reachability import Leg
from irsim.validation.feasibility.scenes import Scene, Thing

__all__ = ["Trap", "trap_of"]

_MOST_CORNERS = 200
"""Things with more corners are left alone."""


@dataclass(frozen=True)
class Trap:
    """A side of something, across the way to the goal.

    Attributes:
        place: The point of it that is nearest to the goal [m].
        length: How long it is [m].
        line: It has no inside.
    """

    place: Point
    length: float
    line: bool


def trap_of(scene: Scene, leg: Leg) -> Trap | None:
    """The side that the straight line meets first, if its point nearest to the goal is not near one of its ends.

    Whoever slides along a side towards the goal comes to that point: beyond it, every step leads away from the goal.
    From a point near an end, the corner is got round.
    """
    best: tuple[float, Trap | None] = (math.inf, None)
    path = [core.Linestring(vertices=[list(leg.start), list(leg.goal)])]
    for thing in scene.things:
        if math.dist(leg.start, leg.goal) == 0 or not core.intersects(path, [0.0, 0.0, 0.0], *thing):
            continue
        for a, b, line in _sides(thing):
            met = _meets(leg.start, leg.goal, a, b)
            if met is not None and met < best[0]:
                best = met, _trap(a, b, leg, line)
        if not any(True for _ in _sides(thing)):  # round, or a map
            return None
    return best[1]


def _trap(a: Point, b: Point, leg: Leg, line: bool) -> Trap | None:
    length = math.dist(a, b)
    along = ((leg.goal[0] - a[0]) * (b[0] - a[0]) + (leg.goal[1] - a[1]) * (b[1] - a[1])) / length
    if not leg.mover.radius < along < length - leg.mover.radius:
        return None
    place = (a[0] + along / length * (b[0] - a[0]), a[1] + along / length * (b[1] - a[1]))
    return Trap(place, length, line)


def _sides(thing: Thing) -> Iterator[tuple[Point, Point, bool]]:
    """Sides of polygons and lines, world frame, and whether it is a line."""
    parts, (x, y, theta) = thing
    cos, sin = math.cos(theta), math.sin(theta)
    for part in parts:
        if not isinstance(part, (core.Polygon, core.Linestring)) or len(part.vertices) > _MOST_CORNERS:
            continue
        corners: list[Any] = [(x + cos * u - sin * v, y + sin * u + cos * v) for u, v in part.vertices]
        line = isinstance(part, core.Linestring)
        for a, b in itertools.pairwise(corners if line else [*corners, corners[0]]):
            if a != b:
                yield a, b, line


def _meets(p: Point, q: Point, a: Point, b: Point) -> float | None:
    """Where on the way from p to q, from 0 to 1, the segment from a to b is crossed."""
    dx, dy, ex, ey = q[0] - p[0], q[1] - p[1], b[0] - a[0], b[1] - a[1]
    across = dx * ey - dy * ex
    if across == 0:
        return None
    t = ((a[0] - p[0]) * ey - (a[1] - p[1]) * ex) / across
    s = ((a[0] - p[0]) * dy - (a[1] - p[1]) * dx) / across
    return t if 0 <= t <= 1 and 0 <= s <= 1 else None
