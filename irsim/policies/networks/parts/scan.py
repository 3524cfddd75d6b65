"""``scan``: ranges of the first lidar."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from irsim.options.units import Bool, Integer, Meters, Radians
from irsim.policies.networks.errors import PolicyInputError
from irsim.policies.networks.features import PARTS
from irsim.policies.networks.parts._options import PartOptions
from irsim.policies.networks.values import Channel, Value
from irsim.policies.observations import Observations, Scan
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

    def channels(self) -> tuple[Channel, ...]:
        """One for each sector."""
        return tuple(Channel(f"sector_{i + 1}", 0.0, 1.0) for i in range(self.sectors))


@PARTS.register(ScanPart)
def scan(observations: Observations, options: ScanPart) -> Value:
    """Observe the ranges of the lidar.

    Args:
        observations: Of B robots, with a scan.
        options: The options of the part.

    Returns:
        (B, n) features.

    Raises:
        PolicyInputError: There is no lidar, it has too few beams, or its beams have other directions.
    """
    seen = observations.scan
    if seen is None:
        raise PolicyInputError("the network observes a lidar, and the robot has none", "add a lidar2d to the robot")
    _check(seen, options)
    beams = seen.ranges.shape[1]
    starts = np.arange(options.sectors) * beams // options.sectors
    nearest = np.minimum.reduceat(seen.ranges, starts, axis=1)
    share = np.clip(nearest / (options.range_max or seen.range_max), 0.0, 1.0)
    return Value(1.0 - share if options.nearness else share)


def _check(seen: Scan, options: ScanPart) -> None:
    beams = seen.ranges.shape[1]
    if beams < options.sectors:
        message = f"the network observes {options.sectors} sectors of a lidar, and the lidar has {beams} beams"
        raise PolicyInputError(message, f"give the lidar number: {options.sectors}, or a multiple of it")
    if options.angles is not None:
        given = [float(seen.angles[0]), float(seen.angles[-1])]
        if max(abs(a - b) for a, b in zip(given, options.angles, strict=True)) > _ANGLE_TOLERANCE:
            wanted = f"{options.angles[0]:.4g} to {options.angles[1]:.4g} rad"
            message = f"the network expects beams from {wanted}, and the lidar has {given[0]:.4g} to {given[1]:.4g} rad"
            raise PolicyInputError(message, "set angle_range and offset of the lidar to those of the training")
