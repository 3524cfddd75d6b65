"""Maps that planners get from an environment."""

from __future__ import annotations

from typing import Any

from irsim.env.access import EnvAccess

__all__ = ["EnvMaps"]


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
        from irsim.navigation.map import world_map

        world = self.scenario.world
        corner = world.bounds[0], world.bounds[1]
        made = world_map(world.width, world.height, corner, self._world.grid_map, resolution, self.obstacle_list)
        if self.scenario.grid is not None and self.scenario.grid.cells is not None:
            made.share_cells(self.scenario.grid.cells)
        made.robot = next(iter(self.robot_list), None)
        made.seed = self._simulation.key()
        made.canvas = self._canvas
        return made

    def _canvas(self) -> Any:
        """The axes, if something has been drawn."""
        return None if self._plot is None or not self._plot.made else self._plot.ax
