"""Names of IR-SIM 2.12 for the state, goals, arrival and contact of an object, which scripts evaluate."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from operator import attrgetter
from typing import Any

import numpy as np

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.objects.base import SimObject, column
from irsim.objects.shapely_geometry import is_taken, touching
from irsim.objects.view import ObjectView

__all__ = ["OldStatus"]

_STOPS = {0: ("robot", "obstacle"), 2: ("robot",)}
"""Roles of the objects that a contact stops, by collision mode of the core."""


def _settable(name: str, setter: str) -> Any:
    """Return a property that reads an attribute, and that calls a method when it is assigned to."""

    def assign(view: ObjectView, value: Any) -> None:
        getattr(view, setter)(value)

    return property(attrgetter(name), assign, doc=f"``{name}``; assigning to it calls ``{setter}``.")


class OldStatus(ObjectView):
    """Names of 2.12 for state, goals, arrival and contact; part of :class:`irsim.compat.objects.view.ScriptObject`."""

    # state and goals -------------------------------------------------------------------------------------------------
    @property
    def state_shape(self) -> tuple[int, int]:
        """(state_dim, 1)."""
        return self.state_dim, 1

    @property
    def vel_shape(self) -> tuple[int, int]:
        """(vel_dim, 1)."""
        return self.vel_dim, 1

    @property
    def original_state(self) -> Floats:
        """Centre of the body's area [m] and heading 0 [rad] in the body frame, (3, 1)."""
        return column([*self.body.original_centroid[:, 0], 0.0])

    @property
    def goal_abbr(self) -> str:
        """Short label of the goal: ``G-r0``."""
        return f"G-{self.drawing.short_label}"

    @property
    def z(self) -> float:
        """Height above the ground [m]; always 0, because the world is flat."""
        return 0.0

    _state = _settable("state", "set_state")
    _velocity = _settable("velocity", "set_velocity")
    _goal = _settable("goals", "set_goal")

    @property
    def arrive_flag(self) -> bool:
        """Whether the object has reached its last goal; may be set, until the next step evaluates it again."""
        return self.arrive

    @arrive_flag.setter
    def arrive_flag(self, value: bool) -> None:
        self._simulation.arrived[self.row] = bool(value)

    @property
    def collision_flag(self) -> bool:
        """Whether the object touches something; may be set, until the next step evaluates it again."""
        return self.collision

    @collision_flag.setter
    def collision_flag(self, value: bool) -> None:
        self._simulation.collided[self.row] = bool(value)

    def set_random_goal(
        self,
        obstacle_list: Iterable[SimObject],
        init: bool = False,
        free: bool = True,
        goal_check_radius: float = 0.2,
        range_limits: Sequence[Sequence[float]] | None = None,
        max_attempts: int = 100,
    ) -> None:
        """Replace every present goal by a random one; an object without a goal gets one.

        Args:
            obstacle_list: Obstacles from which goals keep away.
            init: Also make them the goals to which ``reset`` returns.
            free: Draw each goal until the circle round it touches no obstacle.
            goal_check_radius: Radius of that circle [m].
            range_limits: [low, high] bounds of x, y [m] and heading [rad]; by default the range of the behavior, which
                is by default the world.
            max_attempts: Largest number of draws per goal; the last draw is accepted in any case.
        """
        low, high = (self.record.range_low, self.record.range_high) if range_limits is None else range_limits
        bounds = np.asarray(low, dtype=np.float64).reshape(-1), np.asarray(high, dtype=np.float64).reshape(-1)
        obstacles = list(obstacle_list)
        goals: list[list[float]] = []
        for _ in range(max(1, len(self.goals))):
            for _ in range(max(1, max_attempts)):
                drawn = self._simulation.rng.uniform(*bounds)
                circle = [core.Circle(radius=goal_check_radius, center=drawn[:2].tolist())]
                if not free or not any(is_taken(one, circle, [0.0, 0.0, 0.0]) for one in obstacles):
                    break
            goals.append(drawn.tolist())
        self.set_goal(goals, init)

    def get_vel_range(self) -> tuple[Floats, Floats]:
        """Return the lowest and highest controls that all limits allow in the next step, (vel_dim, 1) each."""
        change = np.asarray(self.acce) * self._simulation.scenario.world.step_time
        now = self.velocity
        return column(np.maximum(self.vel_min, now - change)), column(np.minimum(self.vel_max, now + change))

    def input_state_check(self, state: Sequence[float], dim: int = 3) -> list[float]:
        """Return ``state`` cut to ``dim`` numbers, or filled with zeros to ``dim`` numbers."""
        values = list(state)[:dim]
        return values + [0] * (dim - len(values))

    # arrival and contact ---------------------------------------------------------------------------------------------
    def check_arrive(self, goal: Any, threshold: float | None = None) -> bool:
        """Return whether the object is at a goal.

        Args:
            goal: x, y [m] and, for ``arrive_mode: state``, heading [rad]; None is never reached.
            threshold: Distance below which the goal counts as reached [m]; by default ``goal_threshold``.
        """
        if goal is None:
            return False
        numbers = np.asarray(goal, dtype=np.float64).reshape(-1)
        x, y, theta = self._simulation.pose[self.row].tolist()
        turn = 0.0
        if self.arrive_mode == "state" and numbers.size > 2:
            turn = (theta - numbers[2] + math.pi) % (2 * math.pi) - math.pi
        away = math.sqrt((x - numbers[0]) ** 2 + (y - numbers[1]) ** 2 + turn * turn)
        return away < (self.goal_threshold if threshold is None else threshold)

    def check_arrive_status(self) -> None:
        """Update the arrival flag; at a goal that is not the last one, switch to the next goal instead."""
        goals = self.goals
        arrived = bool(goals) and self.check_arrive(goals[0])
        if arrived and len(goals) > 1:
            rest = [goal[:, 0].tolist() for goal in goals[1:]]
            self._simulation.state.set_goals(self.row, rest, False)
            arrived = False
        self._simulation.arrived[self.row] = arrived

    def check_collision(self, obj: SimObject) -> bool:
        """Return whether the object touches another one now, computed on the exact shapes."""
        return touching(self, obj)

    def check_collision_status(self) -> None:
        """Update the collision flag and the stop flag for the present poses."""
        simulation = self._simulation
        collided = any(self.check_collision(other) for other in self.surroundings.near)
        simulation.collided[self.row] = collided
        simulation.stopped[self.row] = collided and self.role in _STOPS.get(simulation.world.collision_mode, ())

    def check_status(self) -> None:
        """Update the flag of arrival, then the flags of collision and stop, as at the end of a step."""
        self.check_arrive_status()
        self.check_collision_status()

    @property
    def passive(self) -> bool:
        """Whether the object has no drive."""
        return self.record.kinematics is None

    @property
    def drive_tau(self) -> float:
        """Lag of the drive [s]."""
        return self.record.drive_tau

    @property
    def drive_velocity_xy(self) -> Floats:
        """World-frame velocity of the drive before contacts change it, (2, 1) [m/s]."""
        simulation, row = self._simulation, self.row
        handler = None if simulation.drives is None else simulation.drives.handler(row)
        if simulation.drives is None or handler is None:
            return column(simulation.state.drive_velocity_world(row))
        control = simulation.drive_of(row, self.record.vel_dim)[:, None].copy()
        state = simulation.row_state(row, self.record.state_dim)[:, None]
        return column(np.asarray(handler.velocity_to_xy(state, control), dtype=np.float64).reshape(-1)[:2])

    def apply_contact_displacement(self, dxy: Any, dtheta: float = 0.0) -> None:
        """Move the object as a contact does within one period, and change its velocity accordingly.

        Args:
            dxy: Displacement in the world frame, 2 numbers [m].
            dtheta: Rotation about the centroid [rad].
        """
        dx, dy = np.asarray(dxy, dtype=np.float64).reshape(-1)[:2].tolist()
        with self._simulation.resolving_contacts():
            core.shift(self._simulation.world, self._simulation.state, self.row, (dx, dy), float(dtheta))

    def apply_contact_velocity(self, dv: Any) -> None:
        """Add ``dv``, 2 numbers in the world frame [m/s], to the velocity."""
        dx, dy = np.asarray(dv, dtype=np.float64).reshape(-1)[:2].tolist()
        with self._simulation.resolving_contacts():
            core.push(self._simulation.world, self._simulation.state, self.row, (dx, dy))
