"""Maps that planners get from an environment."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from irsim.env_access import EnvAccess

__all__ = ["EnvMaps", "coarser"]

_COARSER, _FINER = 1.05, 0.95
"""Resolutions this much off that of the world's grid count as equal."""


class EnvMaps(EnvAccess):
    """``get_map`` of an environment."""

    _plot: Any

    def get_map(self, resolution: float = 0.1) -> Any:
        """The world as a map to plan on: its extent, its grid, its obstacles; for the footprint of the first robot.

        Args:
            resolution: Size of the cells [m]. Of a world with a grid, cells may be joined to coarser ones (occupied
                where one of them is) but not divided; not positive: those of the grid.

        Returns:
            A :class:`irsim.navigation.map.Map`.
        """
        from irsim.navigation.map import Map

        world = self.scenario.world
        grid = getattr(self._world, "grid_map", None)
        obstacles: list[Any] = self.obstacle_list
        if grid is None:
            if not resolution > 0:
                raise ValueError("a world without a grid needs a positive resolution")
        else:
            own = world.width / grid.shape[0]
            if not resolution > 0:
                resolution = own
            elif resolution > _COARSER * own:
                warnings.warn(
                    f"the grid of the world has cells of {own:g} m: they are joined to cells of {resolution:g} m",
                    UserWarning,
                    stacklevel=2,
                )
                grid = coarser(grid, round(world.width / resolution), round(world.height / resolution))
            elif resolution < _FINER * own:
                warnings.warn(
                    f"the grid of the world has cells of {own:g} m: they are not divided into {resolution:g} m",
                    UserWarning,
                    stacklevel=2,
                )
                resolution = own
        made = Map(world.width, world.height, resolution, obstacles, grid, (world.bounds[0], world.bounds[1]))
        made.robot = next(iter(self.robot_list), None)
        made.seed = self._simulation.key()
        made.canvas = self._canvas
        return made

    def _canvas(self) -> Any:
        """The axes, if something has been drawn."""
        return None if self._plot is None else self._plot.ax


def coarser(grid: Any, columns: int, rows: int) -> Any:
    """The largest value of each block of cells.

    Args:
        grid: (nx, ny) values.
        columns: Blocks along x, at most nx.
        rows: Blocks along y, at most ny.

    Returns:
        (columns, rows) array.
    """
    values = np.asarray(grid)
    columns, rows = min(max(1, columns), values.shape[0]), min(max(1, rows), values.shape[1])
    # a cell counts for every block that it overlaps
    for axis, count in ((0, columns), (1, rows)):
        size = values.shape[axis]
        first = np.arange(count) * size // count
        last = -(-(np.arange(1, count + 1) * size) // count)
        blocks = [np.take(values, range(a, b), axis=axis).max(axis=axis) for a, b in zip(first, last, strict=True)]
        values = np.stack(blocks, axis=axis)
    return values
