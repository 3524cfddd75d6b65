"""``neighbors``: the nearest other objects."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Field

import irsim._core as core
from irsim.options.knowledge import Fact
from irsim.options.units import Bool, Integer, Meters, MetersPerSecond
from irsim.policies.networks.errors import PolicyInputError
from irsim.policies.networks.parts._options import PARTS, PartOptions, unique
from irsim.policies.networks.values import Channel, Frame
from irsim.policies.observations import Observations
from irsim.policies.policy import Needs

Feature = Literal[
    "x", "y", "vx", "vy", "heading_cos", "heading_sin", "radius", "radii", "distance", "gap", "extent",
    "own_extent", "extent_gap", "nearness", "goal_distance", "arrived", "robot", "present",
]  # fmt: skip
_ZERO_TO_ONE = ("radius", "radii", "distance", "goal_distance")
_EXTENTS = ("extent", "own_extent", "extent_gap")
_SHARES = ("nearness", "arrived", "robot", "present")


class NeighborsPart(PartOptions):
    """The nearest other objects: a set of `count` members, nearest first. Absent members are masked and hold zeros.

    - `x`, `y`: position / `distance_max`
    - `vx`, `vy`: velocity / `speed_max`
    - `heading_cos`, `heading_sin`: direction of the heading
    - `radius`: radius of the bounding circle / `radius_max`; `radii`: the sum of both radii / `radius_max`
    - `distance`: between the centers / `distance_max`; `gap`: between the bounding circles / `distance_max`
    - `extent`: how far its footprint reaches toward the robot, along the line between the centers / `radius_max`;
      `own_extent`: how far the robot's reaches toward it; `extent_gap`: the distance between the centers without
      both / `distance_max`, which is never larger than the true distance of convex bodies
    - `nearness`: exp(-gap / `decay`), 1 for circles that overlap
    - `goal_distance`: from the neighbor to the robot's own goal / `distance_max`; 0 without a goal
    - `arrived`: 1 for a robot that has reached its last goal; `robot`: 1 for a robot; `present`: 1
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "neighbors", "count": 6, "range": 4.0}]}

    name: Literal["neighbors"] = "neighbors"
    features: Annotated[list[Feature], Field(min_length=1), AfterValidator(unique)] = [
        "x", "y", "vx", "vy", "radius", "gap", "nearness", "arrived", "robot",
    ]  # fmt: skip
    """The numbers of each neighbor, in this order."""
    count: Annotated[Integer, Field(ge=1, le=256)] = 6
    """Largest number of neighbors."""
    range: Annotated[Meters, Field(gt=0)] | None = None
    """Others with a larger gap between the bounding circles are not seen; null sees everything."""
    static: Bool = False
    """Whether static objects count, each as its bounding circle."""
    nearest_last: Bool = False
    """Order the members from the farthest to the nearest, after the absent ones."""
    frame: Frame = "own"
    """Frame of positions, velocities and headings."""
    relative_velocity: Bool = True
    """Subtract the robot's own velocity."""
    distance_max: Annotated[Meters, Field(gt=0)] = 4.0
    """Distance that becomes 1."""
    speed_max: Annotated[MetersPerSecond, Field(gt=0)] = 1.0
    """Speed that becomes 1."""
    radius_max: Annotated[Meters, Field(gt=0)] = 1.0
    """Radius that becomes 1."""
    decay: Annotated[Meters, Field(gt=0)] = 1.0
    """Gap at which `nearness` is 1/e."""
    clip: Bool = True
    """Whether all numbers are clipped to 1."""

    @property
    def members(self) -> int:
        """The largest number of neighbors."""
        return self.count

    def needs(self) -> Needs:
        """Neighbors."""
        reach = math.inf if self.range is None else self.range
        return Needs(
            neighbors=self.count,
            neighbor_range=reach,
            static_neighbors=self.static,
            neighbor_extents=any(name in _EXTENTS for name in self.features),
        )

    def known(self) -> frozenset[Fact]:
        """Circles, and what its features add."""
        known: set[Fact] = {"circles"}
        known |= {"outlines"} if self.needs().neighbor_extents else set()
        known |= {"arrivals"} if "arrived" in self.features else set()
        known |= {"headings"} if {"heading_cos", "heading_sin"} & set(self.features) else set()
        return frozenset(known)

    def channels(self) -> tuple[Channel, ...]:
        """One for each feature."""
        most = 1.0 if self.clip else math.inf
        bounds = dict.fromkeys(_ZERO_TO_ONE, (0.0, most)) | dict.fromkeys(_SHARES, (0.0, 1.0))
        bounds |= dict.fromkeys(("heading_cos", "heading_sin"), (-1.0, 1.0))
        return tuple(Channel(name, *bounds.get(name, (-most, most))) for name in self.features)

    def check(self, observations: Observations) -> None:
        """Refuse observations with no or fewer neighbors."""
        there = 0 if observations.neighbors is None else observations.neighbors.mask.shape[1]
        if there < self.count:
            what = f"the network observes {self.count} neighbors, not {there}"
            raise PolicyInputError(what, "observe what `needs` declares")
        if self.needs().neighbor_extents and (observations.neighbors is None or observations.neighbors.extent is None):
            raise PolicyInputError("the network observes extents of neighbors", "observe what `needs` declares")


PARTS.register(NeighborsPart, kernel=core.NeighborsOptions)
