"""``map``: a picture of the static objects around the robot."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.options.units import Bool, Integer, Meters
from irsim.policies.networks.errors import PolicyInputError
from irsim.policies.networks.frames import Frame
from irsim.policies.networks.parts._options import PARTS, PartOptions
from irsim.policies.networks.values import Channel
from irsim.policies.observations import Observations
from irsim.policies.policy import Needs


class MapPart(PartOptions):
    """A square picture around the robot: 1 where a static object is, 0 where none is.

    Row i of `cells` x `cells` numbers goes along x of the frame, column j along y. A cell is 1 if any point in it is
    occupied; the points are so dense that they hit every cell of the world's map.
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "map", "cells": 16, "size": 4.0}]}

    name: Literal["map"] = "map"
    cells: Annotated[Integer, Field(ge=1, le=64)] = 16
    """Cells along a side."""
    size: Annotated[Meters, Field(gt=0)] = 4.0
    """Length of a side; the robot is in the middle."""
    frame: Frame = "own"
    """Frame of the picture."""
    outside_occupied: Bool = True
    """Whether everything outside the world counts as occupied."""

    def needs(self) -> Needs:
        """The map, with cells half as large as those of the picture."""
        return Needs(map=True, map_resolution=0.5 * self.size / self.cells)

    def channels(self) -> tuple[Channel, ...]:
        """One for each cell."""
        return tuple(Channel(f"cell_{i}_{j}", 0.0, 1.0) for i in range(self.cells) for j in range(self.cells))

    def check(self, observations: Observations) -> None:
        """Refuse observations without maps."""
        if observations.maps is None:
            raise PolicyInputError("the network observes the map of the world", "observe what `needs` declares")


PARTS.register(MapPart, kernel=core.MapOptions)
