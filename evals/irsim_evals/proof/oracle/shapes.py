"""Geometry of the naive implementation: outlines from the corners that the simulator shows, and free space as what is
left of the world."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any

import shapely

__all__ = ["Point", "Thing", "blocked", "distance_between", "gets_there", "to_point"]

Point = tuple[float, float]
_QUADRANT = 32
"""Sides of a quarter of a disc."""


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

    @cached_property
    def reach(self) -> float:
        """Distance of its outline from its position, at most [m]."""
        return self.radius or max(math.dist(corner, self.at[:2]) for corner in self.view.vertices.T) + 1e-6

    @property
    def outline(self) -> Any:
        """Present outline; of a disc its middle."""
        if self.radius is not None:
            return shapely.Point(self.at[:2])
        corners = self.view.vertices.T
        return shapely.LineString(corners) if self.view.shape == "linestring" else shapely.Polygon(corners)

    @property
    def middle(self) -> Point:
        """Where it is: the middle of a static object, else its position."""
        if not self.view.static:
            return self.at[:2]
        middle = self.outline.centroid
        return middle.x, middle.y


def to_point(thing: Thing, point: Point) -> float:
    """Distance of a point from the edge of a thing; 0 inside [m]."""
    return max(0.0, float(thing.outline.distance(shapely.Point(point))) - (thing.radius or 0.0))


def distance_between(a: Thing, b: Thing) -> float:
    """Distance from edge to edge [m]; at most 0 for things that overlap."""
    return float(a.outline.distance(b.outline)) - (a.radius or 0.0) - (b.radius or 0.0)


def blocked(thing: Thing, a: Point, b: Point) -> bool:
    """Whether a straight line between two points touches a thing."""
    return bool(thing.outline.distance(shapely.LineString([a, b])) <= (thing.radius or 0.0))


def gets_there(
    solids: list[Thing], bounds: tuple[float, float, float, float], start: Point, goal: Point, radius: float
) -> bool:
    """Whether a disc gets from one place to another: both lie in one piece of the world without the grown solids.

    Args:
        solids: The obstacles.
        bounds: x0, y0, x1, y1 of the world [m].
        start, goal: Both ends [m].
        radius: Radius of the disc [m].
    """
    grown = [solid.outline.buffer(radius + (solid.radius or 0.0), quad_segs=_QUADRANT) for solid in solids]
    free = shapely.box(*bounds).difference(shapely.union_all(grown))
    ends = shapely.MultiPoint([start, goal])
    return any(piece.covers(ends) for piece in getattr(free, "geoms", [free]))
