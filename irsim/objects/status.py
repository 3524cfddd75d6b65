"""Evaluation of one object outside a step: arrival, contact, reset, new goals, another body."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import count
from typing import Any

import numpy as np

from irsim.common.outline import outline
from irsim.objects.base import SimObject
from irsim.objects.shapely_geometry import from_shapely, touching, touching_circle
from irsim.simulation.active_env import last_used

__all__ = ["ObjectStatus"]

_STOPS = {0: ("robot", "obstacle"), 2: ("robot",)}
"""Roles of the objects that a contact stops, by collision mode of the core."""


class ObjectStatus(SimObject):
    """Evaluation of one object outside a step; part of :class:`irsim.objects.view.ObjectView`."""

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
        collided = any(self.check_collision(other) for other in self.possible_collision_objects)
        simulation.collided[self.row] = collided
        simulation.stopped[self.row] = collided and self.role in _STOPS.get(simulation.world.collision_mode, ())

    def check_status(self) -> None:
        """Update the flags of arrival, then those of collision and stop, as at the end of a step."""
        self.check_arrive_status()
        self.check_collision_status()

    @property
    def possible_collision_objects(self) -> list[SimObject]:
        """The other objects whose bounding boxes overlap that of this one, without ``unobstructed`` objects."""
        if self.surroundings is None:
            objects = self.environment_objects
            near = [objects[i] for i in self._simulation.state.near_row(self.row)]
            return [other for other in near if not other.unobstructed]
        low, high = outline(self._simulation.state, self.row, world_frame=True).box()
        found = []
        for other in self.external_objects:
            if not other.unobstructed:
                other_low, other_high = outline(other._simulation.state, other.row, world_frame=True).box()
                if (low <= other_high).all() and (other_low <= high).all():
                    found.append(other)
        return found

    # evaluation and reset --------------------------------------------------------------------------------------------
    def sensor_step(self) -> None:
        """Update the sensors for the present poses."""
        self._simulation.state.look()
        self._simulation.measure()

    def refresh(self, sensor_step: bool = True) -> None:
        """Update the object after its state was set; the geometry needs no update.

        Args:
            sensor_step: Update the sensors.
        """
        if sensor_step:
            self.sensor_step()

    def reset(self) -> None:
        """Reset the object to its initial state, control and goals, and clear its flags and trajectory."""
        self._simulation.state.reset_row(self.row)

    def remove(self) -> None:
        """Do nothing; kept for compatibility. ``env.delete_object`` deletes objects."""

    # goals and bodies ------------------------------------------------------------------------------------------------
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
        low, high = (self.rl, self.rh) if range_limits is None else range_limits
        bounds = np.asarray(low, dtype=np.float64).reshape(-1), np.asarray(high, dtype=np.float64).reshape(-1)
        obstacles = list(obstacle_list)
        goals: list[list[float]] = []
        for _ in range(max(1, len(self.goals))):
            for _ in range(max(1, max_attempts)):
                drawn = self._simulation.rng.uniform(*bounds)
                x, y = drawn[:2].tolist()
                if not free or not any(touching_circle(o, x, y, goal_check_radius) for o in obstacles):
                    break
            goals.append(drawn.tolist())
        self.set_goal(goals, init)

    def set_original_geometry(self, geometry: Any) -> None:
        """Replace the body of the object until the next scene.

        Args:
            geometry: shapely polygon, line, or collection of them, in the body frame [m].
        """
        self._simulation.reshape(self.row, from_shapely(geometry))

    # ids -----------------------------------------------------------------------------------------------------------
    @staticmethod
    def reset_id_iter(start: int = 0, step: int = 1) -> None:
        """Restart the ids of new objects in the environment used last."""
        if (env := last_used()) is not None:
            env.env_param.id_iter = count(start, step)

    # settings of behaviors -------------------------------------------------------------------------------------------
    @property
    def rl(self) -> list[float]:
        """Lower bounds of random goals: x, y [m], heading [rad]."""
        return list(self.record.range_low)

    @property
    def rh(self) -> list[float]:
        """Upper bounds of random goals: x, y [m], heading [rad]."""
        return list(self.record.range_high)

    @property
    def group_behavior_dict(self) -> dict[str, Any]:
        """Keys of the group behavior as written in the scenario; empty without one."""
        options = self.record.group_behavior
        return {} if options is None else options.model_dump(exclude_unset=True)

    @property
    def z(self) -> float:
        """Height above the ground [m]; always 0, because the world is flat."""
        return 0.0

    def input_state_check(self, state: Sequence[float], dim: int = 3) -> list[float]:
        """Return ``state`` cut to ``dim`` numbers, or filled with zeros to ``dim`` numbers."""
        values = list(state)[:dim]
        return values + [0] * (dim - len(values))
