"""What an environment lets scripts read: objects, states, scans."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.env.object_list import ObjectList
from irsim.env.parameters import WorldView
from irsim.objects.info import ObjectInfo, ObstacleInfo
from irsim.objects.sensors.contact import Contact, contacts_of
from irsim.objects.view import ObjectView
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.simulation.simulation import Simulation

__all__ = ["EnvAccess"]

Floats = NDArray[np.float64]


class EnvAccess:
    """Queries of an environment; nothing here changes it."""

    scenario: ResolvedScenario
    _simulation: Simulation
    _objects: list[ObjectView]
    _world: WorldView

    @property
    def contacts(self) -> list[Contact]:
        """Contacts of the last step, for ``collision_mode: contact``."""
        return contacts_of(self._simulation)

    @property
    def simulation(self) -> Simulation:
        """The simulation behind the environment, with its arrays."""
        return self._simulation

    @property
    def objects(self) -> ObjectList:
        """All objects: robots, then obstacles, then those added later; appending and removing changes the world."""
        return ObjectList(self, self._objects)  # type: ignore[arg-type]  # an Env has all of these

    @property
    def robot_list(self) -> list[ObjectView]:
        """The robots."""
        return [view for view in self._objects if view.role == "robot"]

    @property
    def obstacle_list(self) -> list[ObjectView]:
        """The obstacles."""
        return [view for view in self._objects if view.role == "obstacle"]

    @property
    def robot(self) -> ObjectView:
        """The first robot.

        Raises:
            IndexError: There is none.
        """
        first = next((view for view in self._objects if view.role == "robot"), None)
        if first is None:
            raise IndexError("this scenario has no robot: add a `robot:` section")
        return first

    @property
    def robot_number(self) -> int:
        """How many robots."""
        return len(self.robot_list)

    @property
    def obstacle_number(self) -> int:
        """How many obstacles."""
        return len(self.obstacle_list)

    @property
    def names(self) -> list[str]:
        """Names of all objects."""
        return [view.name for view in self._objects]

    @property
    def static_objects(self) -> list[ObjectView]:
        """Objects that never move."""
        return [view for view in self._objects if view.static]

    @property
    def dynamic_objects(self) -> list[ObjectView]:
        """Objects that can move."""
        return [view for view in self._objects if not view.static]

    @property
    def step_time(self) -> float:
        """Period of a step [s]."""
        return self._world.step_time

    @property
    def config(self) -> dict[str, Any]:
        """Sections of the scenario as parsed; without ``robot`` or ``obstacle`` those are None, others empty."""
        empty: dict[str, Any] = {"world": {}, "gui": {}, "robot": None, "obstacle": None, "custom": {}}
        return {**empty, **self.scenario.document}

    def get_object_by_name(self, name: str) -> ObjectView | None:
        """The object of that name, or None."""
        return next((view for view in self._objects if view.name == name), None)

    def get_object_by_id(self, object_id: int) -> ObjectView | None:
        """The object of that id, or None."""
        return next((view for view in self._objects if view.id == object_id), None)

    def get_group_by_name(self, name: str) -> list[ObjectView]:
        """The objects whose ``group_name`` it is."""
        return [view for view in self._objects if view.group_name == name]

    def get_robot_state(self) -> Floats:
        """(3 or 4, 1) state of the first robot: x, y [m], heading [rad], steering angle of Ackermann drives."""
        return self.robot.state

    def get_robot_info(self, id: int = 0) -> ObjectInfo:
        """Description of a robot, by its place among the robots."""
        return self._robot(id).info

    def get_robot_info_list(self) -> list[ObjectInfo]:
        """Descriptions of all robots."""
        return [view.info for view in self.robot_list]

    def get_obstacle_info_list(self) -> list[ObstacleInfo]:
        """Where the obstacles are and how big."""
        return [view.get_obstacle_info() for view in self.obstacle_list]

    def get_lidar_scan(self, id: int = 0) -> dict[str, Any]:
        """Scan of the first lidar of a robot; see :meth:`irsim.objects.sensors.lidar.Lidar2D.get_scan`.

        Raises:
            IndexError: No such robot.
            AttributeError: It has no lidar.
        """
        return self._robot(id).get_lidar_scan()

    def get_lidar_offset(self, id: int = 0) -> list[float]:
        """[x, y, theta] of the first lidar of a robot, body frame."""
        return self._robot(id).get_lidar_offset()

    def _robot(self, index: int) -> ObjectView:
        robots = self.robot_list
        if not 0 <= index < len(robots):
            raise IndexError(f"no robot {index}: this scenario has {len(robots)}")
        return robots[index]
