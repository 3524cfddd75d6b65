"""The method of an environment that returns a map for planners."""

from __future__ import annotations

from typing import Any

from irsim.env.queries import obstacle_list, robot_list
from irsim.env.state import EnvState

__all__ = ["get_map"]


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
