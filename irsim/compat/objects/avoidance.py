"""Names for avoidance laws of scripts: desired velocity, discs of neighbours, lines, bodies as inequalities."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.common.outline import Circle, Polygon, outline
from irsim.compat.functions.polygons import polygon_inequality
from irsim.objects.base import column
from irsim.objects.surroundings import AVOIDANCE_MARGIN, discs
from irsim.objects.view import ObjectView

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["OldAvoidance", "convex_inequality"]

Inequality = tuple[Floats | None, Floats | None, str | None, bool | None]
MAX_STRAIGHT_CORNER = 1e-12
"""Largest cross product [m^2] of the two edges at a corner that counts as straight."""

MIN_GOAL_DISTANCE = 0.1
"""Distance [m] to the goal below which the desired velocity is zero."""


def convex_inequality(simulation: Simulation, row: int, *, world_frame: bool) -> Inequality:
    """Return a body as the inequality ``G p <= h``, for convex optimisation.

    Returns:
        (G, h, cone, convex). A convex polygon has one row per edge with its outward normal, not normalised, and the
        cone ``"Rpositive"``. A circle has ``G = [[1, 0], [0, 1], [0, 0]]``, ``h = [cx, cy, -r]`` and the cone
        ``"norm2"``. Other areas give None, None, None, False; lines and maps give four times None.
    """
    match outline(simulation.state, row, world_frame=world_frame).parts:
        case (Circle((x, y), radius),):
            return np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]), np.array([[x], [y], [-radius]]), "norm2", True
        case (Polygon(points),):
            inequality = polygon_inequality(points, MAX_STRAIGHT_CORNER)
        case parts:
            return None, None, None, None if len(parts) == 1 else False
    return (None, None, None, False) if inequality is None else (*inequality, "Rpositive", True)


class OldAvoidance(ObjectView):
    """Names that avoidance laws use; part of :class:`irsim.compat.objects.view.ScriptObject`."""

    @property
    def radius_extend(self) -> float:
        """``radius`` plus the margin that avoidance laws add [m]."""
        return self.radius + AVOIDANCE_MARGIN

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
        return [*self.body.centroid[:, 0].tolist(), *self._world_velocity(), self.radius_extend]

    @property
    def rvo_neighbors(self) -> list[list[float]]:
        """``rvo_neighbor_state`` of all other objects that are not ``unobstructed``."""
        others = [other for other in self.surroundings.others if not other.unobstructed]
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

    # convex inequality -----------------------------------------------------------------------------------------------
    @property
    def G(self) -> Floats | None:
        """Normals of ``G p <= h`` in the body frame; see :func:`irsim.compat.objects.avoidance.convex_inequality`."""
        return self.get_init_Gh()[0]

    @property
    def h(self) -> Floats | None:
        """Right side of ``G p <= h`` in the body frame."""
        return self.get_init_Gh()[1]

    @property
    def cone_type(self) -> str | None:
        """``Rpositive`` for convex polygons, ``norm2`` for circles, else None."""
        return self.get_init_Gh()[2]

    @property
    def convex_flag(self) -> bool | None:
        """Whether the body is convex; None for lines and maps."""
        return self.get_init_Gh()[3]

    def get_init_Gh(self) -> Inequality:
        """Return (G, h, cone_type, convex_flag) of the body in the body frame."""
        return convex_inequality(self._simulation, self.row, world_frame=False)

    def get_Gh(self) -> Inequality:
        """Return (G, h, cone_type, convex_flag) of the body at its present pose in the world frame."""
        return convex_inequality(self._simulation, self.row, world_frame=True)

    def _world_velocity(self) -> list[float]:
        velocity: list[float] = self.velocity_xy[:, 0].tolist()
        return velocity


_NEIGHBOR_STATE = OldAvoidance.rvo_neighbor_state
