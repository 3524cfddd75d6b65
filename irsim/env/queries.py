"""Methods of an environment that read it without changing it: objects, states, scans, events."""

from __future__ import annotations

from typing import Any

import numpy as np

from irsim.common.arrays import Floats
from irsim.compat.objects.info import ObjectInfo, ObstacleInfo
from irsim.compat.objects.view import ScriptObject
from irsim.env.object_list import ObjectList
from irsim.env.state import EnvState
from irsim.objects.sensors.contact import Contact, contacts_of
from irsim.simulation.events import Event, read_events
from irsim.simulation.outcome import Outcome, outcome_of
from irsim.simulation.simulation import Simulation

__all__ = ["get_map"]


def contacts(env: EnvState) -> list[Contact]:
    """Return the contacts of the last step; only ``collision_mode: contact`` records them."""
    return contacts_of(env._simulation)


def simulation(env: EnvState) -> Simulation:
    """Return the simulation behind the environment, with its arrays."""
    return env._simulation


def objects(env: EnvState) -> ObjectList:
    """Return all objects: robots, obstacles, then added objects; changing this list changes the world."""
    return ObjectList(env)


def robot_list(env: EnvState) -> list[ScriptObject]:
    """Return the robots."""
    return [view for view in env._objects if view.role == "robot"]


def obstacle_list(env: EnvState) -> list[ScriptObject]:
    """Return the obstacles."""
    return [view for view in env._objects if view.role == "obstacle"]


def robot(env: EnvState) -> ScriptObject:
    """Return the first robot.

    Raises:
        IndexError: The scenario has no robot.
    """
    first = next((view for view in env._objects if view.role == "robot"), None)
    if first is None:
        raise IndexError("this scenario has no robot: add a `robot:` section")
    return first


def robot_number(env: EnvState) -> int:
    """Return the number of robots."""
    return len(robot_list(env))


def obstacle_number(env: EnvState) -> int:
    """Return the number of obstacles."""
    return len(obstacle_list(env))


def names(env: EnvState) -> list[str]:
    """Return the names of all objects."""
    return [view.name for view in env._objects]


def static_objects(env: EnvState) -> list[ScriptObject]:
    """Return the objects that never move."""
    return [view for view in env._objects if view.static]


def dynamic_objects(env: EnvState) -> list[ScriptObject]:
    """Return the objects that can move."""
    return [view for view in env._objects if not view.static]


def step_time(env: EnvState) -> float:
    """Return the period of a step [s]."""
    return env._world.step_time


def config(env: EnvState) -> dict[str, Any]:
    """Return the sections of the scenario as parsed; missing ``robot`` or ``obstacle`` are None, others are empty."""
    empty: dict[str, Any] = {"world": {}, "gui": {}, "robot": None, "obstacle": None, "custom": {}}
    return {**empty, **env.scenario.document}


def get_object_by_name(env: EnvState, name: str) -> ScriptObject | None:
    """Return the object with this name; None if no object has it."""
    return next((view for view in env._objects if view.name == name), None)


def get_object_by_id(env: EnvState, object_id: int) -> ScriptObject | None:
    """Return the object with this id; None if no object has it."""
    return next((view for view in env._objects if view.id == object_id), None)


def get_group_by_name(env: EnvState, name: str) -> list[ScriptObject]:
    """Return the objects with this ``group_name``."""
    return [view for view in env._objects if view.group_name == name]


def get_robot_state(env: EnvState) -> Floats:
    """Return the state of the first robot, (3 or 4, 1): x, y [m], heading [rad], steering angle of a car [rad]."""
    return robot(env).state


def get_robot_info(env: EnvState, id: int = 0) -> ObjectInfo:
    """Return the description of the robot with this index among the robots."""
    return _robot(env, id).info


def get_robot_info_list(env: EnvState) -> list[ObjectInfo]:
    """Return the descriptions of all robots."""
    return [view.info for view in robot_list(env)]


def get_obstacle_info_list(env: EnvState) -> list[ObstacleInfo]:
    """Return the descriptions of all obstacles, with their positions [m] and sizes [m]."""
    return [view.get_obstacle_info() for view in obstacle_list(env)]


def get_lidar_scan(env: EnvState, id: int = 0) -> dict[str, Any]:
    """Return the scan of the first lidar of a robot; see :meth:`irsim.objects.sensors.lidar.Lidar2D.get_scan`.

    Args:
        id: Index of the robot among the robots.

    Raises:
        IndexError: No robot has this index.
        AttributeError: The robot has no lidar.
    """
    return _robot(env, id).get_lidar_scan()


def get_lidar_offset(env: EnvState, id: int = 0) -> list[float]:
    """Return the pose [x, y, theta] of the first lidar of a robot in its body frame [m, m, rad]."""
    return _robot(env, id).get_lidar_offset()


def _robot(env: EnvState, index: int) -> ScriptObject:
    left = index
    for view in env._objects:
        if view.role == "robot":
            if left == 0:
                return view
            left -= 1
    raise IndexError(f"no robot {index}: this scenario has {robot_number(env)}")


def time(env: EnvState) -> float:
    """Return the simulated time, rounded to 0.01 s [s]."""
    return env._world.time


def sim_time(env: EnvState) -> float:
    """Return the simulated time without rounding [s]."""
    return env._simulation.time


def events(env: EnvState) -> list[Event]:
    """Return the events since the last reset in order of time: arrivals, collisions, zones entered, sights and more."""
    return read_events(env._simulation)


def outcome(env: EnvState) -> Outcome:
    """Return the outcome of the episode: ``running``, ``success``, ``collision`` or ``timeout``.

    ``success`` means that every robot has arrived without a collision; ``collision`` means that a robot has arrived
    after a collision or has been stopped by one; ``timeout`` can occur only with ``world.time_limit``.
    """
    return outcome_of(env._simulation)


def seed(env: EnvState) -> int:
    """Return the seed of the present scenes; ``set_random_seed`` changes it."""
    return env._seed


def rng(env: EnvState) -> np.random.Generator:
    """Return a NumPy random generator for your own code; every reset starts it again, from the key of the episode."""
    return env._simulation.rng


def get_map(env: EnvState, resolution: float = 0.1) -> Any:
    """Return the world as a map for planners: its extent, grid and obstacles, and the footprint of the first robot.

    Args:
        resolution: Size of the cells [m]. If the world has a grid, its cells may be merged into coarser ones (occupied
            if one of them is) but not divided, and a value of 0 or less keeps its cells.

    Returns:
        A :class:`irsim.navigation.map.Map`.
    """
    from irsim.navigation.map import world_map

    world = env.scenario.world
    corner = world.bounds[0], world.bounds[1]
    made = world_map(world.width, world.height, corner, env._world.grid_map, resolution, obstacle_list(env))
    if env.scenario.grid is not None and env.scenario.grid.cells is not None:
        made.share_cells(env.scenario.grid.cells)
    made.robot = next(iter(robot_list(env)), None)
    made.seed = env._simulation.key()
    made.canvas = lambda: _canvas(env)
    return made


def _canvas(env: EnvState) -> Any:
    """Return the axes of the figure; None before the first drawing."""
    return None if env._plot is None or not env._plot.made else env._plot.ax
