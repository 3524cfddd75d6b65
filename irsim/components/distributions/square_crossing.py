"""``square_crossing``: random places in one half of a square, for every scene, with goals in the other half."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import MARGIN, DistributionOptions, Drawn, WorldExtent
from irsim.options.registry import DISTRIBUTIONS
from irsim.options.units import Meters
from irsim.options.vectors import Pose


class SquareCrossing(DistributionOptions):
    """Draw starts in the left or right half of a square, which is drawn as well, and goals in the other half.

    This is square crossing of CrowdNav (Chen et al., ICRA 2019). Objects face the other half. Entries are placed in
    file order. Starts keep `clearance` from starts, and goals from goals, of objects with a fixed place and of entries
    before (of `random` entries, from their starts and static objects). `state`, `goal` and `waypoints` of the entry are
    ignored.
    """

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "square_crossing", "center": [0, 0], "width": 10.0, "clearance": 0.2}]
    }

    name: Literal["square_crossing"] = "square_crossing"
    center: Pose | None = None
    """Middle of the square; null is the middle of the world. A third number is accepted and ignored."""
    width: Annotated[Meters, Field(gt=0)] | None = None
    """Side of the square; null is the shorter side of the world less a metre."""
    clearance: Annotated[Meters, Field(ge=0)] = 0.2
    """Smallest distance between footprints, of starts and of goals."""

    def drawn_in(self, world: WorldExtent) -> Drawn:
        """The square."""
        x, y = (self.center or world.center)[:2]
        width = self.width
        if width is None:
            width = max(min(world.width, world.height) - 2 * MARGIN, 0.0)
        half = width / 2
        kernel = {"center": [x, y], "width": width, "clearance": self.clearance}
        return Drawn([x - half, y - half, -math.pi], [x + half, y + half, math.pi], 0.0, kernel)


DISTRIBUTIONS.register(SquareCrossing, kernel=core.SquareCrossing)
