"""Sizes and top speeds of bodies: largest inner disc, smallest extent; computed without a geometry library."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

import irsim._core as core
from irsim.components.options import BehaviorOptions, CustomOptions
from irsim.scenario.resolve.kernels import parts_of
from irsim.scenario.resolve.resolved import ObjectRecord

if TYPE_CHECKING:
    from irsim.common.arrays import Floats

__all__ = [
    "SizedBody",
    "SizedShape",
    "has_fixed_shape",
    "inner_disc",
    "reach_of",
    "thickness",
    "top_speed",
]

Point = tuple[float, float]
Segment = tuple[Point, Point]
_SEARCH_ROUNDS = 4
"""Rounds of the search for the largest disc; each searches a smaller square."""
_POINTS_PER_SIDE = 12
"""Intervals along each side of that square."""
_MAX_CORNERS = 64
"""Corners of an outline whose width is computed, which takes time cubic in them."""


def has_fixed_shape(shape: Any) -> bool:
    """Whether the shape is the same in every scene."""
    if hasattr(shape, "fixed"):  # a map, or the walls round the world
        return bool(shape.fixed)
    parts = shape.parts if shape.name == "compound" else [shape]
    return not any(getattr(part, "random_shape", False) for part in parts)


def reach_of(shape: Any) -> float:
    """Upper bound of the distance of all points of a shape from its origin [m]."""
    wheelbase = (getattr(shape, "wheelbase", None) or 0.0) / 2
    if shape.name == "circle":
        return wheelbase + math.hypot(*shape.center) + float(shape.radius)
    if shape.name == "rectangle":
        return wheelbase + math.hypot(shape.length, shape.width) / 2
    if shape.name == "compound":
        return max(reach_of(part) + math.hypot(part.pose[0], part.pose[1]) for part in shape.parts)
    if shape.name in ("polygon", "linestring"):
        return max((math.hypot(x, y) for x, y in shape.vertices or [(1.0, 1.0)]), default=0.0)
    return max((_reach_of_part(part) for part in parts_of(shape)), default=math.inf)


def _reach_of_part(part: Any) -> float:
    """The reach of a part for the core, for shapes registered by user code [m]."""
    if hasattr(part, "vertices"):
        return max(math.hypot(x, y) for x, y in part.vertices)
    if hasattr(part, "center") and hasattr(part, "radius"):
        return math.hypot(*part.center) + float(part.radius)
    return math.inf


def inner_disc(parts: Sequence[Any]) -> tuple[float, float, float]:
    """x, y, radius of a large disc inside the body, body frame [m]; radius 0 if the body has no filled part.

    The disc lies inside one part; the union of overlapping parts may hold a larger one.
    """
    best = (0.0, 0.0, 0.0)
    for part in parts:
        if isinstance(part, core.Circle):
            disc = (part.center[0], part.center[1], part.radius)
        elif isinstance(part, core.Polygon):
            disc = _largest_disc(tuple((x, y) for x, y in part.vertices))
        else:
            continue
        if disc[2] > best[2]:
            best = disc
    return best


def thickness(shape: Any) -> float:
    """The smallest extent of the thinnest part of the body [m]: 0 for lines, infinity if unknown."""
    parts, cell = parts_of(shape), min(shape.grid.cell) if hasattr(shape, "grid") else math.inf
    least = math.inf
    for part in parts:
        if isinstance(part, core.Circle):
            least = min(least, 2 * part.radius)
        elif isinstance(part, core.Polygon):
            least = min(least, _min_width([(x, y) for x, y in part.vertices]))
        elif isinstance(part, (core.Linestring, core.Room)):
            return 0.0
        elif isinstance(part, core.GridCells):
            least = min(least, cell)
    return least


def top_speed(record: Any) -> float:
    """Highest speed that any behavior reaches [m/s]: 0 without kinematics, infinity for drives of user code."""
    drive = record.kinematics
    if drive is None or record.static:
        return 0.0
    limits = [max(abs(low), abs(high)) for low, high in zip(record.vel_min, record.vel_max, strict=False)]
    options = record.active_behavior
    options = getattr(options, "local", options)
    built_in = not isinstance(options, CustomOptions | None)
    if drive.speeds == 2:  # dash turns the limits into the direction of the goal
        speed = max(limits[:2]) if getattr(options, "name", "") == "dash" else math.hypot(*limits[:2])
    elif drive.speeds == 1:  # no built-in behavior is faster backwards than forwards
        speed = abs(record.vel_max[0]) if built_in and record.vel_max else limits[0]
    else:
        return math.inf
    return min(speed, options.top_speed_of_its_own()) if isinstance(options, BehaviorOptions) else speed


@lru_cache(maxsize=256)  # thousands of objects may have one shape
def _largest_disc(corners: tuple[tuple[float, float], ...]) -> tuple[float, float, float]:
    """Centre and radius of nearly the largest disc inside an outline."""
    import numpy as np

    square = np.stack(np.meshgrid(*[np.linspace(-1.0, 1.0, _POINTS_PER_SIDE + 1)] * 2), axis=-1).reshape(-1, 2)
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    middle, half = (low + high) / 2, (high - low) / 2
    best = (float(middle[0]), float(middle[1]), max(0.0, float(_signed_distance(corners, middle[None])[0])))
    for _ in range(_SEARCH_ROUNDS):
        points = np.array(best[:2]) + square * half
        distance = _signed_distance(corners, points)
        k = int(np.argmax(distance))
        if distance[k] > best[2] * (1 + 1e-9):
            best = (float(points[k, 0]), float(points[k, 1]), float(distance[k]))
        half = half * (2 / _POINTS_PER_SIDE)
    return best


def _signed_distance(corners: Sequence[tuple[float, float]], points: Floats) -> Floats:
    """(P,) distances from (P, 2) points to the outline, negative outside."""
    import numpy as np

    a = np.asarray(corners, dtype=np.float64)
    edge = np.roll(a, -1, axis=0) - a
    off = points[:, None] - a
    with np.errstate(over="ignore", invalid="ignore"):  # coordinates may be huge
        length = (edge**2).sum(axis=1)
        along = np.clip((off * edge).sum(axis=2) / np.where(length > 0, length, 1.0), 0.0, 1.0)
        least = np.sqrt(((off - along[..., None] * edge) ** 2).sum(axis=2)).min(axis=1)
        b = a + edge
        y = points[:, 1, None]
        crossed = (a[:, 1] > y) != (b[:, 1] > y)
        rise = np.where(edge[:, 1] == 0, 1.0, edge[:, 1])
        left = points[:, 0, None] < a[:, 0] + (y - a[:, 1]) / rise * edge[:, 0]
    inside = np.count_nonzero(crossed & left, axis=1) % 2 == 1
    signed: Floats = np.where(inside, least, -least)
    return signed


def _min_width(corners: list[tuple[float, float]]) -> float:
    """Smallest distance between two parallel lines that enclose the outline [m]."""
    if len(corners) > _MAX_CORNERS:
        return math.inf
    least = math.inf
    for i, (ax, ay) in enumerate(corners):
        for bx, by in corners[i + 1 :]:
            length = math.hypot(bx - ax, by - ay)
            if length == 0:
                continue
            across = [((x - ax) * (by - ay) - (y - ay) * (bx - ax)) / length for x, y in corners]
            least = min(least, max(across) - min(across))
    return least


class SizedShape:
    """Sizes of a shape, each computed when it is asked for, once for all objects that share the shape [m]."""

    def __init__(self, shape: Any) -> None:
        self._shape = shape

    @cached_property
    def parts(self) -> list[Any]:
        """Geometry for the core, body frame."""
        return parts_of(self._shape)

    @cached_property
    def width(self) -> float:
        """Least extent."""
        return thickness(self._shape)

    @cached_property
    def inner_disc(self) -> tuple[float, float, float]:
        """Middle, body frame, and radius of the largest disc inside."""
        return inner_disc(self.parts)

    @property
    def disc(self) -> float:
        """Radius of the largest disc inside."""
        return self.inner_disc[2]

    @cached_property
    def reach(self) -> float:
        """Upper bound of the distance of all points from the origin."""
        return reach_of(self._shape)

    @cached_property
    def around(self) -> float:
        """Radius of the circle about the middle of the largest inner disc that contains the shape."""
        x, y, radius = self.inner_disc
        return radius if self._shape.name == "circle" else self.reach + math.hypot(x, y)


@dataclass(frozen=True)
class SizedBody:
    """An object with the sizes of its shape, its speed and its way."""

    record: ObjectRecord
    shape: SizedShape

    @cached_property
    def speed(self) -> float:
        """Top speed [m/s]."""
        return top_speed(self.record)

    @cached_property
    def legs(self) -> list[Segment]:
        """Straight legs from the start to each goal in turn."""
        goals = [] if self.record.kinematics is None else self.record.goals
        points = [(p[0], p[1]) for p in (self.record.state, *goals)]
        if self.record.loop and len(points) > 1:
            points.append(points[1] if len(points) > 2 else points[0])
        return list(itertools.pairwise(points)) or [(points[0], points[0])]

    @cached_property
    def box(self) -> tuple[float, float, float, float]:
        """xmin, ymin, xmax, ymax of the legs."""
        x, y = zip(*(point for leg in self.legs for point in leg), strict=True)
        return min(x), min(y), max(x), max(y)
