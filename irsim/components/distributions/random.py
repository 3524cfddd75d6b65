"""``random``: random free places for every scene."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import MARGIN, DistributionOptions, Drawn, WorldExtent
from irsim.options.base import Options
from irsim.options.registry import DISTRIBUTIONS
from irsim.options.units import Meters
from irsim.options.vectors import Offset, Point


class KeepClear(Options):
    """Something that random places keep clear of: a point, or an object at its start and at its goals.

    Give either `point` or `object`.
    """

    schema_extra: ClassVar[dict[str, Any]] = {
        "oneOf": [
            {"required": [key], "properties": {key: {"not": {"type": "null"}}}, "title": key}
            for key in ("point", "object")
        ],
        "examples": [{"point": [5, 5], "radius": 1.5}, {"object": "robot_0", "radius": 1.0}],
    }
    also_called: ClassVar[dict[str, str]] = {
        "center": "point",
        "position": "point",
        "at": "point",
        "name": "object",
        "of": "object",
        "distance": "radius",
        "clearance": "radius",
    }

    point: Point | None = None
    """A place of the world: [x, y]."""
    object: Annotated[str, Field(strict=True, min_length=1)] | None = None
    """Name of an object of another entry, or of a group for all its members. Its start counts and, if it drives, its
    goals, too, also where they are random. Order matters only for `circle_crossing` and `square_crossing`, whose
    entries must come before this one."""
    radius: Annotated[Meters, Field(gt=0)]
    """Smallest distance from the footprint to the point, or to the footprint of the object at its start and goals."""


class RandomDistribution(DistributionOptions):
    """Draw starts, then goals, uniformly at random for every scene.

    Entries are placed in file order. Footprints at starts overlap neither objects with a fixed place nor starts drawn
    before; footprints at goals overlap neither static objects nor other goals, but may lie on starts. Static objects
    do not overlap goals that `circle_crossing` and `square_crossing` of entries before have drawn.
    `state` and `goal` of the entry are ignored: `goal_low` and `goal_high` say where goals are, equal ones a single
    place.
    """

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [
            {"name": "random", "range_low": [1, 1, -3.14159], "range_high": [9, 9, 3.14159]},
            {"name": "random", "keep_clear": [{"object": "robot_0", "radius": 1.0}], "goal_distance": 4.0},
            {"name": "random", "range_high": [3, 9, 0], "goal_low": [7, 1, 0], "goal_high": [9, 9, 0]},
        ]
    }
    also_called: ClassVar[dict[str, str]] = {
        "avoid": "keep_clear",
        "keep_away": "keep_clear",
        "exclude": "keep_clear",
        "min_goal_distance": "goal_distance",
        "travel_distance": "goal_distance",
    }

    name: Literal["random"] = "random"
    range_low: Offset | None = None
    """Lower bounds [x, y, theta] of the position of each object and, unless `goal_low` says otherwise, of its goal,
    each drawn on its own: the middle of the object; of a car with `wheelbase`, its rear axle. They do not bound
    footprints, which reach beyond: a disc by its radius, a rectangle by half its diagonal, a car by about (length +
    wheelbase) / 2 ahead of it. Leave that much room to the edge of the world. Null is half a metre inside the world,
    heading -π."""
    range_high: Offset | None = None
    """Upper bounds [x, y, theta] of the same positions, not of footprints, as `range_low`; null is half a metre inside
    the world, heading π."""
    goal_low: Offset | None = None
    """Lower bounds [x, y, theta] of goals, where they lie elsewhere than starts: at the other end of a corridor, say.
    Null is `range_low`."""
    goal_high: Offset | None = None
    """Upper bounds [x, y, theta] of goals; null is `range_high`. Bounds that equal `goal_low` fix the goal of a single
    object."""
    min_distance: Annotated[Meters, Field(ge=0)] = 1.0
    """Smallest distance between the positions of this entry's objects, and between their goals."""
    keep_clear: list[KeepClear] = []
    """Points and objects that the footprints keep clear of, at starts and at goals: around the start and the goal of a
    robot, say, so that random obstacles leave them free."""
    goal_distance: Annotated[Meters, Field(ge=0)] = 0.0
    """Smallest distance from the start of an object to its goal, in a straight line."""

    def drawn_in(self, world: WorldExtent) -> Drawn:
        """The range of the options, by default half a metre inside the world."""
        x0, y0, x1, y1 = world.bounds
        low = self.range_low or [x0 + MARGIN, y0 + MARGIN, -math.pi]
        high = self.range_high or [x1 - MARGIN, y1 - MARGIN, math.pi]
        kernel = {
            "range_low": low,
            "range_high": high,
            "goal_low": self.goal_low or low,
            "goal_high": self.goal_high or high,
            "min_distance": self.min_distance,
            "goal_distance": self.goal_distance,
            "keep_points": [[*item.point, item.radius] for item in self.keep_clear if item.point is not None],
        }
        clear_of = [(item.object, item.radius) for item in self.keep_clear if item.object is not None]
        return Drawn(low, high, self.min_distance, kernel, clear_of)


DISTRIBUTIONS.register(RandomDistribution, kernel=core.RandomPlacement)
