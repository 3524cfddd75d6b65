"""Bodies with their sizes, for checks that compare objects with one another."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from irsim.scenario.resolve.body_size import inner_disc, parts_of, reach_of, thickness, top_speed
from irsim.scenario.resolve.resolved import ObjectRecord

Point = tuple[float, float]
Segment = tuple[Point, Point]


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
    def disc(self) -> float:
        """Radius of the largest disc inside."""
        return inner_disc(self.parts)[2]

    @cached_property
    def reach(self) -> float:
        """Upper bound of the distance of all points from the origin."""
        return reach_of(self._shape)


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
