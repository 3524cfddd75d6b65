"""Observations of policies: arrays over all robots that decide in a step, in all worlds at once."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats

__all__ = ["Bodies", "Map", "Neighbors", "Observations", "Scan"]


@dataclass(frozen=True)
class Bodies:
    """Where bodies are, how they move and how large they are; the shape (...) is (B,) for robots, (B, K) for neighbors.

    Attributes:
        pose: (..., 3) x, y [m], heading [rad], world frame.
        velocity: (..., 2) true velocity [m/s], world frame.
        radius: (...) radius of the bounding circle [m].
        arrived: (...) whether it is a robot that has reached its last goal.
    """

    pose: Floats
    velocity: Floats
    radius: Floats
    arrived: NDArray[np.bool_]


@dataclass(frozen=True)
class Neighbors(Bodies):
    """The K nearest other objects of each of B robots, nearest first by the distance of the bounding circles.

    They are the moving objects whose role the robot targets (``target_roles``) and, if the policy asks for them, static
    objects; unobstructed static ones, the map and the walls round the world are not among them. Rows of absent
    neighbors (``mask`` False) hold zeros. The x, y of a pose is the center of the bounding circle.

    Attributes:
        mask: (B, K) whether there is such a neighbor.
        index: (B, K) index of the object in its world; -1 for absent neighbors.
        robot: (B, K) whether the neighbor is a robot.
        extent: (B, K) how far its footprint reaches from the center of its bounding circle toward the robot, along the
            line between the centers [m]; None unless the policy asks for it.
        own_extent: (B, K) how far the robot's footprint reaches toward the neighbor [m].
    """

    mask: NDArray[np.bool_]
    index: NDArray[np.int64]
    robot: NDArray[np.bool_]
    extent: Floats | None = None
    own_extent: Floats | None = None

    @cached_property
    def position(self) -> Floats:
        """(B, K, 2) x, y of the center of the bounding circle [m], world frame."""
        return np.ascontiguousarray(self.pose[..., :2])

    @cached_property
    def heading(self) -> Floats:
        """(B, K) [rad], world frame."""
        return np.ascontiguousarray(self.pose[..., 2])


@dataclass(frozen=True)
class Scan:
    """Ranges of the first lidar of each of B robots.

    Attributes:
        ranges: (B, n) [m]; a beam that hits nothing has the range ``range_max``.
        angles: (n,) direction of each beam in the frame of the robot [rad].
        range_max: Largest range [m].
        position: (2,) where the lidar is in the frame of the robot [m].
    """

    ranges: Floats
    angles: Floats
    range_max: float
    position: Floats = field(default_factory=lambda: np.zeros(2))


class Map(Protocol):
    """The static objects of a world as a grid."""

    @property
    def occupied(self) -> NDArray[np.bool_]:
        """(nx, ny) whether a static object, or an unknown cell of a map, touches the cell."""

    @property
    def origin(self) -> tuple[float, float]:
        """Corner of the cell (0, 0) with the smallest x and y [m], world frame."""

    @property
    def resolution(self) -> float:
        """Side of a cell [m]."""


@dataclass(frozen=True)
class Observations(Bodies):
    """Observations of B robots that decide; row b is one robot of one world.

    Robots that have arrived are among them as long as they are controlled. Neighbors, scans and maps are present only
    if the policy needs them (:class:`irsim.policies.Needs`).

    Attributes:
        world: (B,) index of the world of each robot, as in :meth:`irsim.policies.Policy.reset`.
        robot: (B,) id of the robot in its world, which it keeps when other objects come and go.
        first: (B,) whether this is the robot's first decision of an episode.
        time: (B,) simulated time [s].
        step_time: Period of the simulation [s].
        steering: (B,) steering angle [rad]; 0 for drives that do not steer.
        yaw_rate: (B,) [rad/s].
        control: (B, 3) control executed in the last step, in the command frame of each drive, zero padded.
        goal: (B, 3) present goal: x, y [m], heading [rad], world frame; NaN without one.
        goal_threshold: (B,) distance to the goal below which a robot has arrived [m].
        low, high: (B, 3) limits of the controls, zero padded.
        neighbors: The nearest other objects.
        scan: Ranges of a lidar.
        maps: One map per row; rows of one world share it.
        commanded: (B, 2) velocity that a policy of velocities commanded last [m/s], world frame; zero before its first
            decision, and for policies of controls.
    """

    world: NDArray[np.int64]
    robot: NDArray[np.int64]
    first: NDArray[np.bool_]
    time: Floats
    step_time: float
    steering: Floats
    yaw_rate: Floats
    control: Floats
    goal: Floats
    goal_threshold: Floats
    low: Floats
    high: Floats
    neighbors: Neighbors | None = None
    scan: Scan | None = None
    maps: tuple[Map, ...] | None = None
    commanded: Floats | None = None

    def __len__(self) -> int:
        return len(self.world)
