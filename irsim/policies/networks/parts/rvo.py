"""Observation parts of RL-RVO: ``rvo_self`` and ``rvo_cones``, reciprocal velocity obstacles of the neighbors."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.options.knowledge import Fact
from irsim.options.units import Bool, Integer, Meters, MetersPerSecond, Seconds
from irsim.policies.networks.errors import PolicyInputError
from irsim.policies.networks.parts._options import PARTS, PartOptions
from irsim.policies.networks.values import Channel
from irsim.policies.observations import Observations
from irsim.policies.policy import Needs


class RvoSelf(PartOptions):
    """The robot's own motion, the velocity that it desires, and its size, in the world frame and not scaled.

    - `vx`, `vy`: velocity [m/s]
    - `desired_vx`, `desired_vy`: velocity of the desired speed toward the goal [m/s]; 0 at the goal and without one
    - `heading`: from -pi to pi [rad]
    - `radius`: radius of the bounding circle plus `margin` [m]

    Source: Han et al.: Reinforcement Learned Distributed Multi-Robot Navigation With Reciprocal Velocity Obstacle
    Shaped Rewards (2022).
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "rvo_self", "margin": 0.1}]}

    name: Literal["rvo_self"] = "rvo_self"
    speed: Annotated[MetersPerSecond, Field(gt=0)] | None = None
    """Desired speed; null is the upper limit of the first control of each robot, or 1 m/s without a limit."""
    margin: Annotated[Meters, Field(ge=0)] = 0.1
    """Added to the robot's own radius."""
    decimals: Annotated[Integer, Field(ge=0, le=9)] | None = 2
    """Numbers are rounded to so many decimals; null keeps them."""

    def known(self) -> frozenset[Fact]:
        """Circles."""
        return frozenset({"circles"})

    def channels(self) -> tuple[Channel, ...]:
        """One for each number."""
        names = ("vx", "vy", "desired_vx", "desired_vy")
        free = [Channel(name, -math.inf, math.inf) for name in names]
        turn = math.ceil(math.pi * 10**9) / 10**9 if self.decimals is None else math.pi + 10.0**-self.decimals
        return (*free, Channel("heading", -turn, turn), Channel("radius", 0.0, math.inf))


PARTS.register(RvoSelf, kernel=core.RvoSelfOptions)


Decimals = Annotated[Integer, Field(ge=0, le=9)]
_OFFSET_S = 0.2
"""Added to times before their inverse is taken [s]."""


class RvoCones(PartOptions):
    """The velocity obstacles of other objects: a set of `count` members, the most urgent one last.

    Absent members come first; they are masked and hold zeros. All numbers are in the world frame.

    - `apex_x`, `apex_y`: apex of the cone: the mean of the velocities of the robot and the other, or 0 for one that
      stands still [m/s]
    - `left_cos`, `left_sin`, `right_cos`, `right_sin`: directions of the legs of the cone, which touch a disc about the
      other; its radius is the sum of both radii and of `margin`
    - `distance`: from the robot's center to the bounding circle of the other [m]
    - `urgency`: 1 / (t + 0.2 s), with the time t until a robot that changed to `velocity` would touch that disc; 0 if
      the velocity is outside the cone or t is `horizon` or more. Of equally urgent members the nearer one is later.

    Source: Han et al.: Reinforcement Learned Distributed Multi-Robot Navigation With Reciprocal Velocity Obstacle
    Shaped Rewards (2022), after van den Berg, Lin, Manocha: Reciprocal Velocity Obstacles (2008).
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "rvo_cones", "count": 5, "range": 4.0}]}

    name: Literal["rvo_cones"] = "rvo_cones"
    count: Annotated[Integer, Field(ge=1, le=256)] = 5
    """Largest number of members: the most urgent ones are kept."""
    nearest: Annotated[Integer, Field(ge=1, le=256)] = 32
    """Number of nearest objects that are looked at."""
    range: Annotated[Meters, Field(gt=0)] = 4.0
    """Others whose center is farther away are not seen."""
    static: Bool = False
    """Whether static objects count, each as its bounding circle."""
    margin: Annotated[Meters, Field(ge=0)] = 0.1
    """Added to the robot's own radius."""
    horizon: Annotated[Seconds, Field(gt=0)] = 5.0
    """Later collisions are not urgent."""
    velocity: Literal["commanded", "present"] = "commanded"
    """Velocity whose collision is timed: the one commanded last (0 before the first one, and for policies that
    return controls), or the present one."""
    decimals: Decimals | None = 2
    """Numbers are rounded to so many decimals; null keeps them."""
    zero_row: Bool = True
    """Whether the set has one member of zeros for a robot that sees no neighbor."""

    @property
    def members(self) -> int:
        """The largest number of members."""
        return self.count

    def needs(self) -> Needs:
        """Neighbors. Their range is one between bounding circles, so that it contains that between centers."""
        return Needs(neighbors=self.nearest, neighbor_range=self.range, static_neighbors=self.static)

    def channels(self) -> tuple[Channel, ...]:
        """One for each number."""
        legs = [Channel(name, -1.0, 1.0) for name in ("left_cos", "left_sin", "right_cos", "right_sin")]
        return (
            Channel("apex_x", -math.inf, math.inf),
            Channel("apex_y", -math.inf, math.inf),
            *legs,
            Channel("distance", -math.inf, math.inf),
            Channel("urgency", 0.0, 1.0 / _OFFSET_S),
        )

    def check(self, observations: Observations) -> None:
        """Refuse observations with no or fewer neighbors, or without the velocity commanded last."""
        there = 0 if observations.neighbors is None else observations.neighbors.mask.shape[1]
        if there < self.nearest:
            what = f"the network observes {self.nearest} neighbors, not {there}"
            raise PolicyInputError(what, "observe what `needs` declares")
        if self.velocity == "commanded" and observations.commanded is None:
            what = "the network observes the velocity that was commanded last"
            raise PolicyInputError(what, "give observations 'commanded'")


PARTS.register(RvoCones, kernel=core.RvoConesOptions)
