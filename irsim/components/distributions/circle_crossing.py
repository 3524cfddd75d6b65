"""``circle_crossing``: random places near a circle, for every scene, with goals opposite."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import MARGIN, DistributionOptions, Drawn, WorldExtent
from irsim.options.registry import DISTRIBUTIONS
from irsim.options.units import Meters
from irsim.options.vectors import Pose


class CircleCrossing(DistributionOptions):
    """Draw starts at random angles of a circle, with noise, for every scene; each goal is opposite, through its centre.

    This is circle crossing of CrowdNav (Chen et al., ICRA 2019). Objects face their goals. Entries are placed in file
    order. Starts and goals keep `clearance` from starts and goals of objects with a fixed place and of crossing entries
    before, and from starts of `random` entries before. `state`, `goal` and `waypoints` of the entry are ignored.
    """

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "circle_crossing", "center": [0, 0], "radius": 4.0, "noise": 0.5, "clearance": 0.2}]
    }

    name: Literal["circle_crossing"] = "circle_crossing"
    center: Pose | None = None
    """Middle of the circle; null is the middle of the world. A third number is accepted and ignored."""
    radius: Annotated[Meters, Field(gt=0)] | None = None
    """Radius of the circle; null keeps starts half a metre inside the world."""
    noise: Annotated[Meters, Field(ge=0)] = 0.5
    """Largest change of x and of y of a start, either way, drawn uniformly; the goal changes by the opposite."""
    clearance: Annotated[Meters, Field(ge=0)] = 0.2
    """Smallest distance between footprints, of starts and of goals."""

    def drawn_in(self, world: WorldExtent) -> Drawn:
        """The square around the circle and its noise."""
        x, y = (self.center or world.center)[:2]
        radius = self.radius
        if radius is None:
            radius = max(min(world.width, world.height) / 2 - MARGIN - self.noise, 0.0)
        reach = radius + self.noise
        kernel = {"center": [x, y], "radius": radius, "noise": self.noise, "clearance": self.clearance}
        return Drawn([x - reach, y - reach, -math.pi], [x + reach, y + reach, math.pi], 0.0, kernel)


DISTRIBUTIONS.register(CircleCrossing, kernel=core.CircleCrossing)
