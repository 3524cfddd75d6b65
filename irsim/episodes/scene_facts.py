"""The facts of a scenario that decide which policy suits it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import shapely
from shapely.affinity import affine_transform
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

import irsim._core as core
from irsim.policies.scene_cards import Span
from irsim.scenario.resolve.body_size import SizedBody, SizedShape, has_fixed_shape, reach_of
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario

__all__ = ["Scene"]

_WALL_REACH = 0.8
"""Static obstacles that reach at least this far from their middle are walls, which have to be driven around [m]."""
_STRAYING = 0.1
"""How far a robot that drives straight strays from the line to its goal [m]: it corrects no small error of its
heading."""


@dataclass(frozen=True)
class Scene:
    """The facts of a scenario that decide which policy suits it."""

    scenario: ResolvedScenario

    @cached_property
    def robots(self) -> list[ObjectRecord]:
        """Its robots that can move."""
        return [one for one in self.scenario.robots() if one.kinematics is not None and not one.static]

    @cached_property
    def people(self) -> list[ObjectRecord]:
        """Obstacles that move."""
        return [one for one in self.scenario.objects if one.role != "robot" and not one.static and not one.unobstructed]

    @cached_property
    def unyielding(self) -> list[ObjectRecord]:
        """People who do not give way to robots."""
        return [
            one for one in self.people
            if one.target_roles == "obstacle" or not getattr(one.active_behavior, "avoids", False)
        ]  # fmt: skip

    @cached_property
    def static(self) -> list[ObjectRecord]:
        """Static obstacles that are in the way, without the map and the walls round the world."""
        return [
            one for one in self.scenario.objects
            if one.role != "robot" and one.static and not one.unobstructed and not one.is_terrain
        ]  # fmt: skip

    @cached_property
    def has_map(self) -> bool:
        """Whether the world has a map."""
        return any(one.is_map for one in self.scenario.objects)

    @property
    def crowding(self) -> float:
        """Robots and moving obstacles on 100 m2 of the world."""
        world = self.scenario.world
        return 100 * (len(self.robots) + len(self.people)) / max(1.0, world.width * world.height)

    @cached_property
    def speeds(self) -> Span:
        """Least and greatest top speed of its robots [m/s]."""
        return _span([SizedBody(one, SizedShape(one.shape)).speed for one in self.robots])

    @cached_property
    def radii(self) -> Span:
        """Least and greatest radius of its robots [m]."""
        return _span([_radius(one) for one in self.robots])

    @cached_property
    def longest_way(self) -> float:
        """Longest straight leg of a robot whose start is written [m]; 0 without one."""
        return max((math.dist(*leg) for leg in self._legs()), default=0.0)

    @cached_property
    def walls_between(self) -> int:
        """Walls on a straight leg of a robot."""
        legs = [LineString(leg) for leg in self._legs() if math.dist(*leg) > 0]
        placed = {index for placement in self.scenario.placements for index in placement.objects}
        walls = (one for one in self.static if one.id not in placed and has_fixed_shape(one.shape))
        outlines = [_outline(one) for one in walls if reach_of(one.shape) >= _WALL_REACH]
        return sum(any(outline.intersects(leg) for leg in legs) for outline in outlines)

    @cached_property
    def drawn_static(self) -> int:
        """Static obstacles whose places each seed draws."""
        placed = {index for placement in self.scenario.placements for index in placement.objects}
        return sum(one.id in placed or not has_fixed_shape(one.shape) for one in self.static)

    @cached_property
    def static_on_ways(self) -> int:
        """Static obstacles that a robot would touch on the straight ways to its goals."""
        placed = {index for placement in self.scenario.placements for index in placement.objects}
        ways = [
            LineString(leg).buffer(SizedShape(one.shape).disc + _STRAYING)
            for one in self.robots
            if one.id not in placed
            for leg in SizedBody(one, SizedShape(one.shape)).legs
        ]
        standing = [_outline(one) for one in self.static if one.id not in placed and has_fixed_shape(one.shape)]
        return sum(any(outline.intersects(way) for way in ways) for outline in standing)

    @cached_property
    def kind(self) -> str:
        """``walls`` with walls or a map, else ``robots`` with several robots and no people; else empty."""
        if self.has_map or any(reach_of(one.shape) >= _WALL_REACH for one in self.static):
            return "walls"
        return "robots" if len(self.robots) > 1 and not self.people else ""

    def _legs(self) -> Iterator[tuple[tuple[float, float], tuple[float, float]]]:
        placed = {index for placement in self.scenario.placements for index in placement.objects}
        for one in self.robots:
            if one.id not in placed:
                yield from SizedBody(one, SizedShape(one.shape)).legs


def _span(values: Sequence[float]) -> Span:
    return (min(values), max(values)) if values else (0.0, 0.0)


def _radius(one: ObjectRecord) -> float:
    """Largest distance of the outline from the middle of the body [m]."""
    drawn = getattr(one.shape, "radius_range", None) or getattr(one.shape, "avg_radius_range", None)
    if getattr(one.shape, "random_shape", False) and drawn:
        return float(drawn[1])
    size = SizedShape(one.shape)
    return size.around if size.disc > 0 else reach_of(one.shape)


def _outline(one: ObjectRecord) -> BaseGeometry:
    """The outline of a static obstacle in the world."""
    x, y, heading = (*one.state[:2], one.state[2] if len(one.state) > 2 else 0.0)
    cos, sin = math.cos(heading), math.sin(heading)
    shapes: list[BaseGeometry] = []
    for part in SizedShape(one.shape).parts:
        if isinstance(part, core.Circle):
            shapes.append(shapely.Point(part.center).buffer(part.radius))
        elif isinstance(part, core.Polygon):
            shapes.append(shapely.Polygon([tuple(point) for point in part.vertices]))
        elif isinstance(part, core.Linestring):
            shapes.append(LineString([tuple(point) for point in part.vertices]))
    return affine_transform(shapely.GeometryCollection(shapes), [cos, -sin, sin, cos, x, y])
