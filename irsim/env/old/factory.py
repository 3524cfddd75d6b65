"""Factories of objects and sensors, and the configuration of an environment, with the names of IR-SIM 2.12."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import count
from typing import Any, Literal

import numpy as np

from irsim.compat.objects.view import ScriptObject, views
from irsim.components.maps._site import HALF
from irsim.env import queries
from irsim.env.old.construct import ObjectBase, ObjectGroup
from irsim.objects.lifecycle import lone_simulation, renumber
from irsim.options.registry import SENSORS
from irsim.scenario.open import open_scenario
from irsim.scenario.read import or_raise, read
from irsim.scenario.single_object import read_object
from irsim.simulation.active_env import last_used
from irsim.simulation.simulation import Simulation

__all__ = ["EnvConfig", "ObjectFactory", "SensorFactory"]


Role = Literal["robot", "obstacle"]


class ObjectFactory:
    """Makes objects that do not belong to a world yet.

    Args:
        world: The world for which objects are made; by default the world of the environment used last.
    """

    def __init__(self, world: Any = None) -> None:
        self.world = world

    def create_robot(self, kinematics: Any = None, **keys: Any) -> ScriptObject:
        """Make a robot from the keys of a scenario entry."""
        return ObjectBase(kinematics=kinematics, role="robot", **{"color": None, **keys})

    def create_obstacle(self, kinematics: Any = None, **keys: Any) -> ScriptObject:
        """Make an obstacle from the keys of a scenario entry."""
        return ObjectBase(kinematics=kinematics, role="obstacle", **{"color": None, **keys})

    def create_object(self, obj_type: str = "robot", number: int = 1, **keys: Any) -> list[ScriptObject]:
        """Make the objects of one entry; ``number`` and ``distribution`` work as in a file."""
        return self.create_from_parse({"number": number, **keys}, obj_type)

    def create_from_parse(
        self,
        parse: Sequence[Mapping[str, Any]] | Mapping[str, Any],
        obj_type: str = "robot",
        group_start_index: int = 0,
    ) -> list[ScriptObject]:
        """Make the objects of an entry or of a list of entries.

        Args:
            parse: The entry or entries, with the keys of a scenario file.
            obj_type: ``robot`` or ``obstacle``.
            group_start_index: Number of the group of the first entry.

        Raises:
            ScenarioError: A key or value of an entry is not valid.
        """
        entries = [dict(parse)] if isinstance(parse, Mapping) else [dict(entry) for entry in parse]
        env = last_used()
        document = {"world": self._extent(), obj_type: entries}
        scenario, _ = or_raise(read(document, name=f"create_{obj_type}"))
        seed = 0 if env is None else int(env.rng.integers(2**32))
        together = Simulation(scenario, [seed], history=True)
        numbers = count() if env is None else env.env_param.id_iter
        made = []
        for view in views(together):
            own = lone_simulation(scenario, view.record, seed)
            own.exchange(own.scenario, [(together, view.row)])
            single = views(own)[0]
            single.group += group_start_index
            renumber(single, next(numbers))
            made.append(single)
        return made

    def generate_state_list(
        self,
        number: int = 1,
        distribution: Mapping[str, Any] | None = None,
        state: Sequence[Any] | None = None,
        goal: Sequence[Any] | None = None,
    ) -> tuple[list[list[float]], list[list[float]]]:
        """Return the states and the goals that a distribution gives ``number`` objects."""
        entry = {"number": number, "distribution": distribution, "state": state, "goal": goal}
        given = {key: value for key, value in entry.items() if value is not None}
        made = self.create_from_parse({**given, "shape": {"name": "circle", "radius": 0.01}}, "robot")
        goals = [[] if view.goal is None else view.goal[:, 0].tolist() for view in made]
        return [view.state[:, 0].tolist() for view in made], goals

    def create_from_map(
        self, points: Any, reso: Any, grid_map: Any = None, world_offset: Sequence[float] | None = None
    ) -> list[ScriptObject]:
        """Make one obstacle of all occupied cells of a map.

        Args:
            points: (2, M) centres of the occupied cells [m]; without points no obstacle is made.
            reso: Extent of a cell along x and y [m].
            grid_map: (nx, ny) occupancies; by default ``points`` are entered into a grid over the world.
            world_offset: Lower left corner of the map [m]; by default the corner of the world.

        Returns:
            A list of one :class:`irsim.compat.objects.view.ObstacleMap`, or an empty list.
        """
        centres = np.empty((2, 0)) if points is None else np.asarray(points, dtype=np.float64)
        if not centres.size:
            return []
        cell = np.broadcast_to(np.asarray(reso, dtype=np.float64).reshape(-1), (2,))
        extent = self._extent() or {"width": 10.0, "height": 10.0, "offset": [0.0, 0.0]}
        corner = np.asarray(extent["offset"] if world_offset is None else world_offset, dtype=np.float64)[:2]
        grid = None if grid_map is None else np.asarray(grid_map, dtype=np.float64)
        if grid is None or not (grid > HALF).any():
            wide = extent["width"] / cell[0], extent["height"] / cell[1]
            size = grid.shape if grid is not None else (max(1, round(wide[0])), max(1, round(wide[1])))
            grid = np.zeros(size)
            i, j = np.floor((centres - corner[:, None]) / cell[:, None]).astype(int)
            inside = (i >= 0) & (j >= 0) & (i < size[0]) & (j < size[1])
            grid[i[inside], j[inside]] = 100.0
        width, height = (float(v) for v in grid.shape * cell)
        world = {"width": width, "height": height, "offset": corner.tolist(), "obstacle_map": grid}
        scenario, _ = or_raise(read({"world": world}, name="create_from_map"))
        made = views(Simulation(scenario, [0], history=True))[-1:]
        for view in made:
            env = last_used()
            number = 0 if env is None else next(env.env_param.id_iter)
            view.__dict__.update(id=number, name=f"obstacle_{number}")
        return made

    def _extent(self) -> dict[str, Any]:
        env = last_used()
        world = self.world if self.world is not None else None if env is None else env._world
        return {} if world is None else {"width": world.width, "height": world.height, "offset": list(world.offset)}


class EnvConfig:
    """The scenario of an environment as parsed.

    Args:
        env: The environment.
    """

    def __init__(self, env: Any) -> None:
        self._env = env
        self.object_factory = ObjectFactory(env._world)

    @property
    def parse(self) -> dict[str, Any]:
        """Sections of the file: ``world``, ``gui``, ``robot``, ``obstacle``, ``custom``; see ``env.config``."""
        return queries.config(self._env)

    @property
    def world_name(self) -> str:
        """Name of the file as the caller wrote it, or else name of the scenario."""
        given = self._env.world_name
        return self._env.scenario.name if given is None else str(given)

    @property
    def world_file_path(self) -> str | None:
        """Path of the scenario file; None for a scenario without a file."""
        source: str | None = self._env.scenario.source
        return source

    @property
    def logger(self) -> Any:
        """The logger of the environment."""
        return self._env.logger

    def load_yaml(self, world_name: str | None = None) -> None:
        """Check that a scenario file can be read, and use it from the next ``reload`` on."""
        name = self.world_name if world_name is None else world_name
        open_scenario(name)
        self._env.world_name = name

    def initialize_objects(self) -> tuple[Any, ...]:
        """Start the next scene with the objects of the file.

        Returns:
            (world, objects, plot or None in headless mode, robots, obstacles, maps, groups).
        """
        env = self._env
        env.reset(random=True)
        maps = [view for view in env.obstacle_list if view.record.is_map]
        obstacles = [view for view in env.obstacle_list if not view.record.is_map]
        members: dict[Any, list[ScriptObject]] = {}
        for view in env.objects:
            if not view.record.is_map:
                members.setdefault(view.group, []).append(view)
        groups = [ObjectGroup(views, number) for number, views in members.items()]
        plot = None if env.headless else env._env_plot
        return env._world, env.objects, plot, env.robot_list, obstacles, maps, groups

    def reload_objects(self) -> list[ScriptObject]:
        """Start the next scene with the objects of the file, and return them."""
        self._env.reset(random=True)
        return queries.objects(self._env)

    def reload_yaml_objects(self, world_name: str | None = None) -> list[ScriptObject]:
        """Read the scenario again, or another one, start it, and return its objects."""
        self._env.reload(world_name)
        return queries.objects(self._env)


class SensorFactory:
    """Makes sensors that do not belong to an object of an environment."""

    def create_sensor(self, state: Any, obj_id: int, **kwargs: Any) -> Any:
        """Make a sensor whose carrier is the only object of an empty world.

        Args:
            state: Pose of the carrier, x, y [m] and heading [rad], in any shape.
            obj_id: Id of the carrier.
            **kwargs: Keys of a sensor in a scenario; without ``name`` and ``type`` the sensor is a ``lidar2d``.

        Raises:
            NotImplementedError: No sensor has that name.
            ScenarioError: A key or value is not valid.
        """
        name = str(kwargs.get("name", kwargs.get("type", "lidar2d")))
        if SENSORS.get(name) is None:
            raise NotImplementedError(f"there is no sensor {name!r}: choose one of {', '.join(SENSORS.names())}")
        scenario, _ = or_raise(read({"world": {}}))
        pose = np.asarray(state, dtype=np.float64).reshape(-1)[:3].tolist()
        keys = {"state": pose, "shape": {"name": "circle"}, "sensors": [kwargs]}
        record, _ = read_object("obstacle", keys, scenario.world, obj_id)
        return views(lone_simulation(scenario, record, 0))[0].sensors[0]
