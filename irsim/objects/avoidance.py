"""What avoidance laws ask of an object: wanted velocities, discs of neighbours, segments of lines."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.objects.base import column
from irsim.objects.geometry import ObjectBody
from irsim.objects.neighbors import discs

__all__ = ["ObjectAvoidance"]

Floats = NDArray[np.float64]
_THRESHOLD = 0.1
"""Nearer than this to the goal [m] nobody wants to move."""
_PER_AXIS = ("omni", "omni_angular", None)


class ObjectAvoidance(ObjectBody):
    """What avoidance laws ask of an object; part of :class:`irsim.objects.view.ObjectView`."""

    @property
    def desired_omni_vel(self) -> Floats:
        """(2, 1) world velocity straight to the goal at full speed [m/s]; zero at the goal or without one."""
        return self.get_desired_omni_vel()

    def get_desired_omni_vel(self, goal_threshold: float = _THRESHOLD, normalized: bool = False) -> Floats:
        """The world velocity straight to the goal.

        Args:
            goal_threshold: Nearer than this [m] the answer is zero.
            normalized: With length 1 at most.

        Returns:
            (2, 1) [m/s]: full speed of each axis times the direction, ``vel_max`` of the first component on both axes
            for ``diff`` and ``acker``.
        """
        goal = self.goal
        if goal is None:
            return column([0.0, 0.0])
        dx, dy = (np.asarray(goal)[:2, 0] - self._simulation.pose[self.row, :2]).tolist()
        distance = math.hypot(dx, dy)
        if distance <= goal_threshold:
            return column([0.0, 0.0])
        top = self.record.vel_max
        first, second = (top[0], top[1] if self.kinematics in _PER_AXIS and len(top) > 1 else top[0])
        vx, vy = first * dx / distance, second * dy / distance
        length = math.hypot(vx, vy)
        return column([vx / length, vy / length] if normalized and length > 1 else [vx, vy])

    @property
    def rvo_state(self) -> list[float]:
        """[x, y, vx, vy, radius + 0.1, wanted vx, wanted vy, theta], world frame."""
        x, y, theta = self._simulation.pose[self.row].tolist()
        return [x, y, *self._world_velocity(), self.radius_extend, *self.desired_omni_vel[:, 0].tolist(), theta]

    @property
    def rvo_neighbor_state(self) -> list[float]:
        """[x, y, vx, vy, radius + 0.1] of the centre of its area, world frame."""
        return [*self.centroid[:, 0].tolist(), *self._world_velocity(), self.radius_extend]

    @property
    def rvo_neighbors(self) -> list[list[float]]:
        """``rvo_neighbor_state`` of all others that are not ``unobstructed``."""
        others = [other for other in self.external_objects if not other.unobstructed]
        kinds: set[Any] = set(map(type, others))
        if not others or any(kind.rvo_neighbor_state is not _NEIGHBOR_STATE for kind in kinds):
            return [other.rvo_neighbor_state for other in others]
        everybody: list[list[float]] = discs(others[0]._simulation, others[0].world).tolist()
        return [everybody[other.index] for other in others]

    @property
    def rvo_line_segments(self) -> list[list[float]]:
        """[x1, y1, x2, y2] of each segment of a linestring, world frame; empty for other shapes."""
        outline = self.vertices
        if self.shape != "linestring" or outline is None:
            return []
        return [[*a, *b] for a, b in pairwise(outline.T.tolist())]

    def vel_world2body(self, velocity_xy: Any) -> Floats:
        """The control with which its drive follows a world velocity.

        Args:
            velocity_xy: vx, vy [m/s] in any shape.

        Returns:
            (vel_dim, 1) control in the command frame; of the limits only the yaw rate of ``diff`` is kept.

        Raises:
            NotImplementedError: It has no drive.
        """
        if self.kinematics is None:
            raise NotImplementedError(f"{self.name!r} has no drive that could follow a velocity")
        vx, vy = np.asarray(velocity_xy, dtype=np.float64).reshape(2).tolist()
        control = core.follow(self._simulation.world, self._simulation.state, self.row, (vx, vy))
        if self.kinematics == "diff":
            control = (control[0], min(max(control[1], -self.record.vel_max[1]), self.record.vel_max[1]), 0.0)
        return column(control[: self.vel_dim])

    def _world_velocity(self) -> list[float]:
        velocity: list[float] = self.velocity_xy[:, 0].tolist()
        return velocity


_NEIGHBOR_STATE = ObjectAvoidance.rvo_neighbor_state
