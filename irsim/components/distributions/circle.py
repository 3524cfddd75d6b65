"""``circle``: evenly on a circle, facing its middle."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim.common.angles import wrap
from irsim.components.options import DistributionOptions, WorldExtent
from irsim.options.registry import DISTRIBUTIONS
from irsim.options.units import Meters, Radians
from irsim.options.vectors import Pose


class CircleDistribution(DistributionOptions):
    """Place objects evenly on a circle, facing its middle; goals are opposite unless the entry has a `goal`."""

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [
            {"name": "circle", "center": [5, 5], "radius": 4.0},
            {"name": "circle", "radius": 4.0, "start_angle": 1.5708},
        ]
    }

    name: Literal["circle"] = "circle"
    center: Pose | None = None
    """Middle of the circle; null is the middle of the world. A third number is accepted and ignored: see
    `start_angle`."""
    radius: Annotated[Meters, Field(gt=0)] | None = None
    """Radius of the circle; null is half the shorter side of the world less half a metre."""
    start_angle: Radians = 0.0
    """Direction from the middle to the first object, counterclockwise from the x axis: 1.5708 is the top."""


@DISTRIBUTIONS.register(CircleDistribution)
def place(options: CircleDistribution, count: int, world: WorldExtent) -> list[tuple[list[float], list[float]]]:
    """Pose and goal of each of ``count`` objects: (x, y, theta), world frame, heading in [-pi, pi)."""
    center, radius = options.center or world.center, options.radius
    if radius is None:
        radius = max(min(world.width, world.height) / 2 - 0.5, 0.0)
    placed = []
    for i in range(count):
        angle = options.start_angle + 2 * math.pi * i / count
        dx, dy = radius * math.cos(angle), radius * math.sin(angle)
        heading = wrap(angle - math.pi)
        start = [center[0] + dx, center[1] + dy, heading]
        placed.append((start, [center[0] - dx, center[1] - dy, heading]))
    return placed
