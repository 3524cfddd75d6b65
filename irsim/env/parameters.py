"""Parameter objects of one environment, for its world, its objects and its paths, with the names of IR-SIM."""

from __future__ import annotations

import math
import platform
from collections.abc import Callable, Iterator, Sequence
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.installed import script_folder
from irsim.common.log import Logger
from irsim.components.maps._grid import merged
from irsim.components.maps._site import HALF
from irsim.diagnostics.errors import InputError
from irsim.objects.base import column
from irsim.objects.describe import grid_values
from irsim.objects.lifecycle import amend_world
from irsim.objects.setters import refuse
from irsim.simulation.active_env import last_used
from irsim.simulation.build import COLLISION_MODES
from irsim.simulation.fog import FogMap, fog_resolution

if TYPE_CHECKING:
    from irsim.compat.objects.view import ScriptObject
    from irsim.simulation.simulation import Simulation

__all__ = ["EnvParam", "PathParam", "WorldParam", "WorldView"]

_CONTROL_MODES = ("auto", "keyboard")
_CONTACT_SETTINGS = ("gravity", "friction", "restitution", "drive_tau")
_SCENARIO_SETTINGS = ("name", "width", "height", "offset", "plot_parse", "depth")
_IN_SCENARIO = "set it in the section `world` of the scenario"


def checked_step_mode(mode: str) -> str:
    """Return ``internal`` or ``external`` in lower case.

    Raises:
        ValueError: ``mode`` is neither of the two.
    """
    chosen = str(mode).strip().lower()
    if chosen not in ("internal", "external"):
        raise InputError(f"unknown step_mode {mode!r}", "choose internal or external")
    return chosen


def set_step_time(simulation: Simulation, seconds: float) -> None:
    """Change the period of a step.

    Raises:
        ValueError: The period is not positive.
        AttributeError: Steps have been executed in this episode; the clock, a count of steps, would be wrong.
    """
    value = float(seconds)
    if value == simulation.scenario.world.step_time:
        return
    if not (math.isfinite(value) and value > 0):
        raise InputError(f"the period of a step is a positive number of seconds, not {seconds!r}")
    if simulation.count.any():
        refuse("the world", "step_time", "the clock counts steps of one length; `reset()` first, or " + _IN_SCENARIO)
    amend_world(simulation, step_time=value)


class _Clock:
    """The clock of a simulation, which the world and its parameters both show."""

    _simulation: Simulation

    @property
    def step_time(self) -> float:
        """Period of a step [s]."""
        return float(self._simulation.scenario.world.step_time)

    @step_time.setter
    def step_time(self, seconds: float) -> None:
        set_step_time(self._simulation, seconds)

    @property
    def count(self) -> int:
        """Number of executed steps; the simulated time is this number times ``step_time``."""
        return int(self._simulation.count[0])

    @count.setter
    def count(self, steps: int) -> None:
        self._simulation.count[0] = int(steps)

    @property
    def time(self) -> float:
        """Simulated time, rounded to 0.01 s."""
        return round(self.count * self.step_time, 2)


class WorldParam(_Clock):
    """Time and modes of one environment.

    ``control_mode``, ``collision_mode``, ``step_mode`` and ``count`` may be changed at run time, ``step_time`` before
    the first step of an episode; all others are fixed by the scenario.
    """

    gravity: float
    friction: float
    restitution: float
    drive_tau: float

    def __init__(self, simulation: Simulation, step_mode: str) -> None:
        world = simulation.scenario.world
        self._simulation = simulation
        self._step_mode = checked_step_mode(step_mode)
        self._control_mode: str = world.control_mode
        self._collision_mode: str = world.collision_mode
        self.__dict__.update({name: getattr(world, name) for name in _CONTACT_SETTINGS})

    def __setattr__(self, name: str, value: Any) -> None:
        if name in (*_CONTACT_SETTINGS, "time"):
            refuse("the world", name, _IN_SCENARIO)
        object.__setattr__(self, name, value)

    @property
    def step_mode(self) -> str:
        """``internal`` (irsim moves the objects) or ``external`` (the caller moves them)."""
        return self._step_mode

    @step_mode.setter
    def step_mode(self, mode: str) -> None:
        self._step_mode = checked_step_mode(mode)

    @property
    def control_mode(self) -> str:
        """``auto`` or ``keyboard``."""
        return self._control_mode

    @control_mode.setter
    def control_mode(self, mode: str) -> None:
        if mode not in _CONTROL_MODES:
            raise InputError(f"unknown control mode {mode!r}", f"choose {' or '.join(_CONTROL_MODES)}")
        self._control_mode = mode

    @property
    def collision_mode(self) -> str:
        """How objects react to a collision: the value of ``collision_mode``."""
        return self._collision_mode

    @collision_mode.setter
    def collision_mode(self, mode: str) -> None:
        if mode not in COLLISION_MODES:
            raise InputError(f"unknown collision mode {mode!r}", f"choose one of {', '.join(COLLISION_MODES)}")
        self._collision_mode = mode
        self._simulation.world.collision_mode = COLLISION_MODES[mode]


class EnvParam:
    """Objects, logger and id counter of one environment.

    Args:
        objects: Function that returns the objects of the environment.
        logger: Logger of the environment.
    """

    def __init__(self, objects: Callable[[], list[ScriptObject]], logger: Logger) -> None:
        self._objects, self.logger = objects, logger
        self.platform_name = platform.system()
        self.id_iter: Iterator[int] = count(len(objects()))

    @property
    def objects(self) -> list[ScriptObject]:
        """``env.objects``."""
        return self._objects()


class PathParam:
    """Folders beside the running script, to which figures and animations are written.

    Without a script, as in a notebook, they are in the working directory.
    """

    def __init__(self) -> None:
        self.root_path = script_folder() or str(Path.cwd())
        self.ani_buffer_path = self.root_path + "/animation_buffer"
        self.ani_path = self.root_path + "/animation"
        self.fig_path = self.root_path + "/figure"


class WorldView(_Clock):
    """The world of one environment: extent, time, sampling.

    ``count``, ``sample_time``, ``status`` and ``step_mode`` may be set at any time, ``step_time`` before the first
    step; all others are fixed by the scenario.
    """

    name: str
    width: float
    height: float
    offset: list[float]
    plot_parse: Any

    def __init__(self, simulation: Simulation) -> None:
        world = simulation.scenario.world
        self._simulation = simulation
        self.__dict__.update(
            name=simulation.scenario.name,
            width=world.width,
            height=world.height,
            offset=[float(v) for v in world.offset],
            plot_parse=world.plot,
        )
        self._status, self._step_mode = str(world.status), checked_step_mode(world.step_mode)
        self._sample_time: float | None = world.sample_time
        self._logger: Logger | None = None
        self._fog: FogMap | None = None
        if world.fog_map:
            resolution = fog_resolution(simulation.scenario)
            self._fog = FogMap(world.width, world.height, resolution, self.offset)

    def __setattr__(self, name: str, value: Any) -> None:
        kind = getattr(type(self), name, None)
        if name in _SCENARIO_SETTINGS or (isinstance(kind, property) and kind.fset is None):
            refuse("the world", name, _IN_SCENARIO)
        object.__setattr__(self, name, value)

    @property
    def sample_time(self) -> float:
        """Period of the drawn frames [s]; by default the period of a step."""
        return self.step_time if self._sample_time is None else self._sample_time

    @sample_time.setter
    def sample_time(self, seconds: float) -> None:
        value = float(seconds)
        if not (math.isfinite(value) and value > 0):
            raise InputError(f"the period of the frames is a positive number of seconds, not {seconds!r}")
        self._sample_time = value

    @property
    def status(self) -> str:
        """Status word of the title, as ``env.status``; a written one is shown until the next step."""
        owner = self._simulation.owner()
        return self._status if owner is None else str(owner.status)

    @status.setter
    def status(self, word: str) -> None:
        owner = self._simulation.owner()
        if owner is None:
            self._status = str(word)
        else:
            owner.set_status(word)

    @property
    def step_mode(self) -> str:
        """``internal`` (irsim moves the objects) or ``external`` (the caller moves them), as ``env.step_mode``."""
        owner = self._simulation.owner()
        return self._step_mode if owner is None else str(owner.step_mode)

    @step_mode.setter
    def step_mode(self, mode: str) -> None:
        owner = self._simulation.owner()
        if owner is None:
            self._step_mode = checked_step_mode(mode)
        else:
            owner.step_mode = mode

    @property
    def steps_per_sample(self) -> int:
        """Number of steps from one drawn frame to the next."""
        return max(1, int(round(self.sample_time / self.step_time, 9)))

    @property
    def x_range(self) -> list[float]:
        """[xmin, xmax] of the world [m]."""
        return [self.offset[0], self.offset[0] + self.width]

    @property
    def y_range(self) -> list[float]:
        """[ymin, ymax] of the world [m]."""
        return [self.offset[1], self.offset[1] + self.height]

    @property
    def sampling(self) -> bool:
        """Whether the present step is drawn."""
        return self.count % self.steps_per_sample == 0

    # a world without an environment ----------------------------------------------------------------------------------
    def step(self, objects: Any = None) -> None:
        """Advance time by one period in which no object moves; an environment uses its own ``step`` instead.

        Args:
            objects: Ignored, accepted for compatibility.
        """
        self._simulation.step_external()

    def reset(self) -> None:
        """Set the time to 0 and cover the whole fog map; objects stay where they are."""
        self._simulation.count[0] = 0
        if self._fog is not None:
            self._simulation.state.explored[0] = 0

    def gen_grid_map(self, obstacle_map: Any, mdownsample: int = 1) -> tuple[Any, Any, Any]:
        """Make the grid that a value of ``obstacle_map`` describes, for the extent of this world.

        Args:
            obstacle_map: None, an array, a picture file name, or a mapping with the name of a generator.
            mdownsample: Merge blocks of N x N cells, each of which has the largest occupancy of its cells.

        Returns:
            Occupancies (nx, ny), indices of the occupied cells (2, M), and centres of these cells (2, M) [m]; three
            times None without a map.
        """
        from irsim.components.maps._generators import resolve_obstacle_map

        values = resolve_obstacle_map(obstacle_map, self.width, self.height)
        if values is None:
            return None, None, None
        values = merged(values, mdownsample)
        index = np.array(np.nonzero(values > HALF), dtype=np.int64)
        cell = np.array([[self.width / values.shape[0]], [self.height / values.shape[1]]])
        return values, index, np.array(self.offset)[:2, None] + (index + 0.5) * cell

    def get_map(self, resolution: float = 0.1, obstacle_list: Sequence[Any] | None = None) -> Any:
        """Return the world as a map for planners; see :meth:`irsim.env.env_base.Env.get_map`.

        Args:
            resolution: Size of the cells [m].
            obstacle_list: Obstacles to enter besides the grid.
        """
        from irsim.navigation.map import world_map

        low = float(self.offset[0]), float(self.offset[1])
        return world_map(self.width, self.height, low, self.grid_map, resolution, obstacle_list)

    @property
    def logger(self) -> Logger:
        """The logger of the environment; without one, the last used environment's, or a new logger."""
        owner = self._simulation.owner() or last_used()
        if owner is not None:
            result: Logger = owner.logger
            return result
        if self._logger is None:
            self._logger = Logger()
        return self._logger

    @property
    def fog_map(self) -> FogMap | None:
        """The map of the cells that robots have seen; None without ``world.fog_map``."""
        if self._fog is not None:
            self._fog.cells = self._simulation.state.explored[0]
        return self._fog

    @property
    def grid_map(self) -> NDArray[np.float64] | None:
        """Occupancies from 0 to 100, -1 where unknown, (nx, ny); None without a map."""
        return grid_values(self._simulation)

    @property
    def reso(self) -> NDArray[np.float64]:
        """Extent of a map cell along x and y [m], (2, 1); zeros without a map."""
        grid = self._simulation.scenario.grid
        return column(grid.cell if grid is not None else (0.0, 0.0))

    @property
    def obstacle_index(self) -> NDArray[np.int64] | None:
        """Indices i, j of the occupied cells, (2, M); None without a map."""
        values = self.grid_map
        return None if values is None else np.array(np.nonzero(values > HALF), dtype=np.int64)

    @property
    def obstacle_positions(self) -> NDArray[np.float64] | None:
        """Centres of the occupied cells [m], (2, M); None without a map."""
        index = self.obstacle_index
        return None if index is None else np.array(self.offset)[:2, None] + (index + 0.5) * self.reso
