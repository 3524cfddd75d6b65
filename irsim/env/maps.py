"""Maps that planners get from an environment."""

from __future__ import annotations

from typing import Any

from irsim.env.queries import obstacle_list, robot_list
from irsim.env.state import EnvState

__all__ = ["get_map"]


def get_map(env: EnvState, resolution: float = 0.1) -> Any:
    """The world as a map to plan on: its extent, its grid, its obstacles; for the footprint of the first robot.

    Args:
        resolution: Size of the cells [m]. Of a world with a grid, cells may be joined to coarser ones (occupied
            where one of them is) but not divided; not positive: those of the grid.

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
    """The axes, if something has been drawn."""
    return None if env._plot is None or not env._plot.made else env._plot.ax
