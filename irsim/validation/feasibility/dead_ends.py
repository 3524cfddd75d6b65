"""Dead ends in which a behavior without path planning gets stuck: walls, and circles side by side."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import shapely

import irsim._core as core
from irsim.validation.feasibility.clearance_grid import Point
from irsim.validation.feasibility.reachability import Leg
from irsim.validation.feasibility.scenes import StartState, Thing

__all__ = ["Trap", "first_pocket", "trap_of"]

_MAX_CIRCLES = 60
"""Number of circles beside a straight line up to which pairs of them are looked at."""
_MAX_CORNERS = 200
"""Obstacles with more corners are skipped."""


@dataclass(frozen=True)
class Trap:
    """A side of an obstacle, or two circles, across the straight line to the goal.

    Attributes:
        place: The point of the side that is nearest to the goal, or the place that touches both circles [m].
        length: Length of the side, or the width of both circles [m].
        gap: Gap between both circles [m]; None for a side.
    """

    place: Point
    length: float
    gap: float | None = None


def trap_of(scene: StartState, leg: Leg) -> Trap | None:
    """The side that the straight line meets first, if its point nearest to the goal is not near one of its ends.

    A robot that slides along the side towards the goal stops at that point, as every further step leads away from the
    goal. From a point near an end it gets around the corner. Only obstacles whose convex hull holds the start count:
    the behaviors pass all others on the nearer side.
    """
    best: tuple[float, Trap | None] = (math.inf, None)
    path = [core.Linestring(vertices=[list(leg.start), list(leg.goal)])]
    for thing in scene.things:
        if math.dist(leg.start, leg.goal) == 0 or not core.intersects(path, [0.0, 0.0, 0.0], *thing):
            continue
        if not _surrounds(thing, leg.start):
            continue
        for a, b in _sides(thing):
            met = _meets(leg.start, leg.goal, a, b)
            if met is not None and met < best[0]:
                best = met, _trap(a, b, leg)
    return best[1]


def first_pocket(scene: StartState, route: list[Leg]) -> tuple[Leg, Trap] | None:
    """The first leg that leads between two static circles which the body does not fit between, and where it stops."""
    for leg in route:
        body = leg.mover.shape.around
        circles = list(_circles(scene))
        reach = 2 * body + max((radius for *_, radius in circles), default=0.0)
        near = [circle for circle in circles if _is_beside(leg, circle, reach)]
        if len(near) > _MAX_CIRCLES:
            return None
        for a, b in itertools.combinations(near, 2):
            trap = _pocket(a, b, body, leg)
            if trap is not None:
                return leg, trap
    return None


def _circles(scene: StartState) -> Iterator[tuple[float, float, float]]:
    """Centre and radius of every static circle, world frame [m]."""
    for parts, (x, y, theta) in scene.things:
        cos, sin = math.cos(theta), math.sin(theta)
        for part in parts:
            if isinstance(part, core.Circle):
                u, v = part.center
                yield x + cos * u - sin * v, y + sin * u + cos * v, part.radius


def _is_beside(leg: Leg, circle: tuple[float, float, float], reach: float) -> bool:
    """Whether a circle is within a distance of the straight line [m]."""
    (px, py), (qx, qy), (x, y, radius) = leg.start, leg.goal, circle
    dx, dy = qx - px, qy - py
    along = ((x - px) * dx + (y - py) * dy) / (dx * dx + dy * dy or 1.0)
    share = min(1.0, max(0.0, along))
    return math.hypot(px + share * dx - x, py + share * dy - y) < radius + reach


def _pocket(a: tuple[float, float, float], b: tuple[float, float, float], body: float, leg: Leg) -> Trap | None:
    """The place that touches two circles, if the way to the goal leads between them there and from the start."""
    length = math.dist(a[:2], b[:2])
    gap = length - a[2] - b[2]
    if not (length > 0 and gap < 2 * body) or _meets(leg.start, leg.goal, a[:2], b[:2]) is None:
        return None
    ux, uy = (b[0] - a[0]) / length, (b[1] - a[1]) / length
    from_a, from_b = a[2] + body, b[2] + body
    along = (length**2 + from_a**2 - from_b**2) / (2 * length)
    if from_a <= abs(along):
        return None
    away = math.copysign(math.sqrt(from_a**2 - along**2), ux * (leg.start[1] - a[1]) - uy * (leg.start[0] - a[0]))
    place = (a[0] + along * ux - away * uy, a[1] + along * uy + away * ux)
    if _meets(place, leg.goal, a[:2], b[:2]) is None:
        return None
    return Trap(place, length + a[2] + b[2], max(0.0, gap))


def _surrounds(thing: Thing, place: Point) -> bool:
    """Whether the convex hull of the sides of an obstacle holds a place. A circle or a map has no sides."""
    corners = [end for a, b in _sides(thing) for end in (a, b)]
    return bool(corners) and bool(shapely.MultiPoint(corners).convex_hull.contains(shapely.Point(place)))


def _trap(a: Point, b: Point, leg: Leg) -> Trap | None:
    length = math.dist(a, b)
    along = ((leg.goal[0] - a[0]) * (b[0] - a[0]) + (leg.goal[1] - a[1]) * (b[1] - a[1])) / length
    if not leg.mover.radius < along < length - leg.mover.radius:
        return None
    place = (a[0] + along / length * (b[0] - a[0]), a[1] + along / length * (b[1] - a[1]))
    return Trap(place, length)


def _sides(thing: Thing) -> Iterator[tuple[Point, Point]]:
    """Both ends of each side of polygons and lines, world frame."""
    parts, (x, y, theta) = thing
    cos, sin = math.cos(theta), math.sin(theta)
    for part in parts:
        if not isinstance(part, (core.Polygon, core.Linestring)) or len(part.vertices) > _MAX_CORNERS:
            continue
        corners: list[Any] = [(x + cos * u - sin * v, y + sin * u + cos * v) for u, v in part.vertices]
        line = isinstance(part, core.Linestring)
        for a, b in itertools.pairwise(corners if line else [*corners, corners[0]]):
            if a != b:
                yield a, b


def _meets(p: Point, q: Point, a: Point, b: Point) -> float | None:
    """Share of the way from p to q, 0 to 1, at which it crosses the segment from a to b; None if it does not."""
    dx, dy, ex, ey = q[0] - p[0], q[1] - p[1], b[0] - a[0], b[1] - a[1]
    across = dx * ey - dy * ex
    if across == 0:
        return None
    t = ((a[0] - p[0]) * ey - (a[1] - p[1]) * ex) / across
    s = ((a[0] - p[0]) * dy - (a[1] - p[1]) * dx) / across
    return t if 0 <= t <= 1 and 0 <= s <= 1 else None
