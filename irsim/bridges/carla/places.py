"""Places and velocities of the scenario in a town of CARLA, whose y points to the right and whose yaw is clockwise."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from irsim.bridges.frames import axes_of, planar_pose, pose_matrix, to_frame, to_irsim
from irsim.common.arrays import Floats

__all__ = ["Places"]


@dataclass(frozen=True)
class Places:
    """Where the scenario is.

    Attributes:
        x, y: Origin of the scenario [m], frame of CARLA.
        yaw: Direction of its x axis [deg], clockwise.
    """

    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0

    @property
    def transform(self) -> Floats:
        """(4, 4) the motion that is applied after the change to CARLA's axes."""
        return pose_matrix(np.array([self.x, self.y, math.radians(self.yaw)]))

    @property
    def matrix(self) -> Floats:
        """(4, 4) ``T_carla_from_irsim``: maps points x, y, z, 1 of irsim to CARLA."""
        axes = np.eye(4)
        axes[:3, :3] = axes_of("carla")
        result: Floats = self.transform @ axes
        return result

    def to_carla(self, pose: Floats) -> Floats:
        """(..., 3) x, y [m], yaw [deg] of CARLA for poses (..., 3) x, y [m], yaw [rad] of irsim."""
        result = planar_pose(to_frame(pose_matrix(pose), "carla", self.transform))
        result[..., 2] = np.degrees(result[..., 2])
        return result

    def to_irsim(self, place: Floats) -> Floats:
        """The inverse of :meth:`to_carla`."""
        place = np.array(place, dtype=np.float64)
        place[..., 2] = np.radians(place[..., 2])
        return planar_pose(to_irsim(pose_matrix(place), "carla", self.transform))

    def velocity_to_carla(self, velocity: Floats) -> Floats:
        """(..., 3) velocity x, y [m/s] and yaw rate [deg/s] of CARLA for (..., 3) vx, vy [m/s], yaw rate [rad/s]."""
        result = np.array(velocity, dtype=np.float64)
        result[..., :2] = result[..., :2] @ self.matrix[:2, :2].T
        result[..., 2] = -np.degrees(result[..., 2])
        return result

    def velocity_to_irsim(self, velocity: Floats) -> Floats:
        """The inverse of :meth:`velocity_to_carla`."""
        result = np.array(velocity, dtype=np.float64)
        result[..., :2] = result[..., :2] @ self.matrix[:2, :2]
        result[..., 2] = -np.radians(result[..., 2])
        return result
