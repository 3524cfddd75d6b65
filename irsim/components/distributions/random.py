"""``random``: random free places for every scene."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.distributions._options import MARGIN, DistributionOptions, Drawn, WorldExtent
from irsim.options.registry import DISTRIBUTIONS
from irsim.options.units import Meters
from irsim.options.vectors import Offset


class RandomDistribution(DistributionOptions):
    """Draw starts, then goals, uniformly at random for every scene.

    Entries are placed in file order. Footprints at starts overlap neither objects with a fixed place nor starts drawn
    before; footprints at goals overlap neither static objects nor other goals of the entry, but may lie on starts.
    Static objects do not overlap goals that `circle_crossing` and `square_crossing` of entries before have drawn.
    `state` and `goal` of the entry are ignored.
    """

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "random", "range_low": [1, 1, -3.14159], "range_high": [9, 9, 3.14159]}]
    }

    name: Literal["random"] = "random"
    range_low: Offset | None = None
    """Lower bounds [x, y, theta] of the middle of each object and of its goal, each drawn on its own; footprints may
    reach beyond. Null is half a metre inside the world, heading -π."""
    range_high: Offset | None = None
    """Upper bounds [x, y, theta], as `range_low`; null is half a metre inside the world, heading π."""
    min_distance: Annotated[Meters, Field(ge=0)] = 1.0
    """Smallest distance between the positions of this entry's objects, and between their goals."""

    def drawn_in(self, world: WorldExtent) -> Drawn:
        """The range of the options, by default half a metre inside the world."""
        x0, y0, x1, y1 = world.bounds
        low = self.range_low or [x0 + MARGIN, y0 + MARGIN, -math.pi]
        high = self.range_high or [x1 - MARGIN, y1 - MARGIN, math.pi]
        return Drawn(
            low, high, self.min_distance, {"range_low": low, "range_high": high, "min_distance": self.min_distance}
        )


DISTRIBUTIONS.register(RandomDistribution, kernel=core.RandomPlacement)
