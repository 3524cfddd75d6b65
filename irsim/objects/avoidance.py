"""The part of an object that avoidance laws use: desired velocity, discs of neighbours, segments of lines."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.objects.base import column
from irsim.objects.geometry import ObjectBody
from irsim.objects.neighbors import discs

__all__ = ["ObjectAvoidance"]

MIN_GOAL_DISTANCE = 0.1
"""Distance [m] to the goal below which the desired velocity is zero."""


class ObjectAvoidance(ObjectBody):
    """Properties that avoidance laws use; part of :class:`irsim.objects.view.ObjectView`."""

    @property
    def desired_omni_vel(self) -> Floats:
        """World-frame velocity straight to the goal at full speed, (2, 1) [m/s]; zero at the goal or without one."""
        return self.get_desired_omni_vel()

    def get_desired_omni_vel(self, goal_threshold: float = MIN_GOAL_DISTANCE, normalized: bool = False) -> Floats:
        """Return the world-frame velocity straight to the goal.

        Args:
            goal_threshold: Distance to the goal below which the velocity is zero [m].
            normalized: Limit the length of the velocity to 1 m/s.

        Returns:
            Velocity (2, 1) [m/s]: the direction to the goal times the largest speed of each axis. For ``diff`` and
            ``acker`` the first component of ``vel_max`` holds for both axes.
        """
        goal = self.goal
        if goal is None:
            return column([0.0, 0.0])
        dx, dy = (np.asarray(goal)[:2, 0] - self._simulation.pose[self.row, :2]).tolist()
        distance = math.hypot(dx, dy)
        if distance <= goal_threshold:
            return column([0.0, 0.0])
        top = self._simulation.limits(self.row)[1].tolist()
        first, second = (
            top[0],
            top[1] if getattr(self.record.kinematics, "speeds", 2) == 2 and len(top) > 1 else top[0],
        )
        vx, vy = first * dx / distance, second * dy / distance
        length = math.hypot(vx, vy)
        return column([vx / length, vy / length] if normalized and length > 1 else [vx, vy])

    @property
    def rvo_state(self) -> list[float]:
        """[x, y, vx, vy, radius + 0.1, desired vx, desired vy, theta], world frame."""
        x, y, theta = self._simulation.pose[self.row].tolist()
        return [x, y, *self._world_velocity(), self.radius_extend, *self.desired_omni_vel[:, 0].tolist(), theta]

    @property
    def rvo_neighbor_state(self) -> list[float]:
        """[x, y, vx, vy, radius + 0.1], world frame; x and y are the centre of the body's area."""
        return [*self.centroid[:, 0].tolist(), *self._world_velocity(), self.radius_extend]

    @property
    def rvo_neighbors(self) -> list[list[float]]:
        """``rvo_neighbor_state`` of all other objects that are not ``unobstructed``."""
        others = [other for other in self.external_objects if not other.unobstructed]
        kinds: set[Any] = set(map(type, others))
        if not others or any(kind.rvo_neighbor_state is not _NEIGHBOR_STATE for kind in kinds):
            return [other.rvo_neighbor_state for other in others]
        all_discs: list[list[float]] = discs(others[0]._simulation, others[0].world).tolist()
        return [all_discs[other.index] for other in others]

    @property
    def rvo_line_segments(self) -> list[list[float]]:
        """[x1, y1, x2, y2] of each segment of a linestring, world frame; empty for other shapes."""
        outline = self.vertices
        if self.shape != "linestring" or outline is None:
            return []
        return [[*a, *b] for a, b in pairwise(outline.T.tolist())]

    def vel_world2body(self, velocity_xy: Any) -> Floats:
        """Return the control with which the drive follows a world-frame velocity.

        Args:
            velocity_xy: vx, vy [m/s] in any shape.

        Returns:
            Control (vel_dim, 1) in the command frame. Limits are not applied, except that on the yaw rate of ``diff``.

        Raises:
            NotImplementedError: The object has no drive.
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
