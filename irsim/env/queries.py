"""What an environment lets scripts read: objects, states, scans; nothing here changes it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.env.object_list import ObjectList
from irsim.env.state import EnvState
from irsim.objects.info import ObjectInfo, ObstacleInfo
from irsim.objects.sensors.contact import Contact, contacts_of
from irsim.objects.view import ObjectView
from irsim.simulation.events import Event, read_events
from irsim.simulation.outcome import Outcome, outcome_of
from irsim.simulation.simulation import Simulation

Floats = NDArray[np.float64]


def contacts(env: EnvState) -> list[Contact]:
    """Contacts of the last step, for ``collision_mode: contact``."""
    return contacts_of(env._simulation)


def simulation(env: EnvState) -> Simulation:
    """The simulation behind the environment, with its arrays."""
    return env._simulation


def objects(env: EnvState) -> ObjectList:
    """All objects: robots, then obstacles, then those added later; appending and removing changes the world."""
    return ObjectList(env)


def robot_list(env: EnvState) -> list[ObjectView]:
    """The robots."""
    return [view for view in env._objects if view.role == "robot"]


def obstacle_list(env: EnvState) -> list[ObjectView]:
    """The obstacles."""
    return [view for view in env._objects if view.role == "obstacle"]


def robot(env: EnvState) -> ObjectView:
    """The first robot.

    Raises:
        IndexError: There is none.
    """
    first = next((view for view in env._objects if view.role == "robot"), None)
    if first is None:
        raise IndexError("this scenario has no robot: add a `robot:` section")
    return first


def robot_number(env: EnvState) -> int:
    """How many robots."""
    return len(robot_list(env))


def obstacle_number(env: EnvState) -> int:
    """How many obstacles."""
    return len(obstacle_list(env))


def names(env: EnvState) -> list[str]:
    """Names of all objects."""
    return [view.name for view in env._objects]


def static_objects(env: EnvState) -> list[ObjectView]:
    """Objects that never move."""
    return [view for view in env._objects if view.static]


def dynamic_objects(env: EnvState) -> list[ObjectView]:
    """Objects that can move."""
    return [view for view in env._objects if not view.static]


def step_time(env: EnvState) -> float:
    """Period of a step [s]."""
    return env._world.step_time


def config(env: EnvState) -> dict[str, Any]:
    """Sections of the scenario as parsed; without ``robot`` or ``obstacle`` those are None, others empty."""
    empty: dict[str, Any] = {"world": {}, "gui": {}, "robot": None, "obstacle": None, "custom": {}}
    return {**empty, **env.scenario.document}


def get_object_by_name(env: EnvState, name: str) -> ObjectView | None:
    """The object of that name, or None."""
    return next((view for view in env._objects if view.name == name), None)


def get_object_by_id(env: EnvState, object_id: int) -> ObjectView | None:
    """The object of that id, or None."""
    return next((view for view in env._objects if view.id == object_id), None)


def get_group_by_name(env: EnvState, name: str) -> list[ObjectView]:
    """The objects whose ``group_name`` it is."""
    return [view for view in env._objects if view.group_name == name]


def get_robot_state(env: EnvState) -> Floats:
    """(3 or 4, 1) state of the first robot: x, y [m], heading [rad], steering angle of Ackermann drives."""
    return robot(env).state


def get_robot_info(env: EnvState, id: int = 0) -> ObjectInfo:
    """Description of a robot, by its place among the robots."""
    return _robot(env, id).info


def get_robot_info_list(env: EnvState) -> list[ObjectInfo]:
    """Descriptions of all robots."""
    return [view.info for view in robot_list(env)]


def get_obstacle_info_list(env: EnvState) -> list[ObstacleInfo]:
    """Where the obstacles are and how big."""
    return [view.get_obstacle_info() for view in obstacle_list(env)]


def get_lidar_scan(env: EnvState, id: int = 0) -> dict[str, Any]:
    """Scan of the first lidar of a robot; see :meth:`irsim.objects.sensors.lidar.Lidar2D.get_scan`.

    Raises:
        IndexError: No such robot.
        AttributeError: It has no lidar.
    """
    return _robot(env, id).get_lidar_scan()


def get_lidar_offset(env: EnvState, id: int = 0) -> list[float]:
    """[x, y, theta] of the first lidar of a robot, body frame."""
    return _robot(env, id).get_lidar_offset()


def _robot(env: EnvState, index: int) -> ObjectView:
    robots = robot_list(env)
    if not 0 <= index < len(robots):
        raise IndexError(f"no robot {index}: this scenario has {len(robots)}")
    return robots[index]


def time(env: EnvState) -> float:
    """Simulated time, rounded to 0.01 s."""
    return round(int(env._simulation.count[0]) * env._world.step_time, 2)


def sim_time(env: EnvState) -> float:
    """Simulated time, unrounded [s]."""
    return env._simulation.time


def events(env: EnvState) -> list[Event]:
    """Arrivals, waypoints and collisions since the last reset, in order."""
    return read_events(env._simulation)


def outcome(env: EnvState) -> Outcome:
    """How it ended: ``running``, ``success``, ``collision`` or ``timeout``.

    Success means that every robot arrived and none collided before, collision that one arrived after a collision or
    stands because of one; ``timeout`` needs ``world.time_limit``.
    """
    return outcome_of(env._simulation)


def seed(env: EnvState) -> int:
    """The seed of the present scenes; another one by ``set_random_seed``."""
    return env._seed


def rng(env: EnvState) -> np.random.Generator:
    """A NumPy generator for your own code; it starts anew with every reset, from this episode's key."""
    return env._simulation.rng
