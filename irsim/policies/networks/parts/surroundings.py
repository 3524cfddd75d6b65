"""Observation parts of static things around the robot: ``scan`` of a lidar and ``map``."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.options.knowledge import Fact
from irsim.options.units import Bool, Integer, Meters, Radians
from irsim.policies.networks.errors import PolicyInputError
from irsim.policies.networks.parts._options import PARTS, PartOptions
from irsim.policies.networks.values import Channel, Frame
from irsim.policies.observations import Observations
from irsim.policies.policy import Needs

_ANGLE_TOLERANCE = 1e-3
"""Difference from the expected directions that counts as rounding [rad]."""


class ScanPart(PartOptions):
    """The shortest range of each of `sectors` groups of neighboring beams, divided by `range_max`."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "scan", "sectors": 36}]}

    name: Literal["scan"] = "scan"
    sectors: Annotated[Integer, Field(ge=1, le=4096)] = 36
    """Number of groups; the lidar needs at least as many beams."""
    range_max: Annotated[Meters, Field(gt=0)] | None = None
    """Range that becomes 1, also for longer ranges; null is the largest range of the lidar."""
    nearness: Bool = False
    """Give 1 - range, so that 0 means that nothing is near."""
    angles: Annotated[list[Radians], Field(min_length=2, max_length=2)] | None = None
    """Directions of the first and the last beam in the frame of the robot that the lidar must have; null accepts any
    lidar."""

    def needs(self) -> Needs:
        """A lidar."""
        return Needs(scan=True)

    def known(self) -> frozenset[Fact]:
        """A lidar."""
        return frozenset({"scan"})

    def channels(self) -> tuple[Channel, ...]:
        """One for each sector."""
        return tuple(Channel(f"sector_{i + 1}", 0.0, 1.0) for i in range(self.sectors))

    def check(self, observations: Observations) -> None:
        """Refuse observations without a lidar, with too few beams, or with beams in other directions."""
        if observations.scan is None:
            message = "the network observes a lidar, but the robot has no lidar"
            raise PolicyInputError(message, "add a lidar2d to the robot")
        self.check_beams(observations.scan.angles)

    def check_beams(self, beams: Floats) -> None:
        """Refuse a lidar that has too few beams, or beams in other directions.

        Args:
            beams: (n,) directions in the frame of the robot [rad].
        """
        if len(beams) < self.sectors:
            message = f"the network observes {self.sectors} sectors of a lidar, and the lidar has {len(beams)} beams"
            raise PolicyInputError(message, f"give the lidar number: {self.sectors}, or a multiple of it")
        if self.angles is None:
            return
        given = [float(beams[0]), float(beams[-1])]
        if max(abs(a - b) for a, b in zip(given, self.angles, strict=True)) > _ANGLE_TOLERANCE:
            wanted = f"{self.angles[0]:.4g} to {self.angles[1]:.4g} rad"
            message = f"the network expects beams from {wanted}, and the lidar has {given[0]:.4g} to {given[1]:.4g} rad"
            raise PolicyInputError(message, "set angle_range and offset of the lidar as in the training")


PARTS.register(ScanPart, kernel=core.ScanOptions)


class MapPart(PartOptions):
    """A square picture around the robot: 1 where a static object is, 0 where none is.

    Row i of `cells` x `cells` numbers goes along x of the frame, column j along y. A cell is 1 if any point in it is
    occupied or unknown; the points are so dense that they hit every cell of the world's map.
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
        """The map, with cells half as large as in the picture."""
        return Needs(map=True, map_resolution=0.5 * self.size / self.cells)

    def known(self) -> frozenset[Fact]:
        """The map."""
        return frozenset({"map"})

    def channels(self) -> tuple[Channel, ...]:
        """One for each cell."""
        return tuple(Channel(f"cell_{i}_{j}", 0.0, 1.0) for i in range(self.cells) for j in range(self.cells))

    def check(self, observations: Observations) -> None:
        """Refuse observations without maps."""
        if observations.maps is None:
            raise PolicyInputError("the network observes the map of the world", "observe what `needs` declares")


PARTS.register(MapPart, kernel=core.MapOptions)
