"""The map as scripts see it: one more static obstacle, with its grid."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irsim.objects.base import column
from irsim.objects.view import ObjectView
from irsim.simulation.occupancy import grid_collision_geometry

if TYPE_CHECKING:
    import irsim._core as core
    from irsim.simulation.simulation import Simulation

__all__ = ["ObstacleMap", "grid_values"]

Floats = NDArray[np.float64]


def grid_values(simulation: Simulation, world: int = 0) -> Floats | None:
    """(nx, ny) occupancies, 0 to 100, of the map of one world; None without a map."""
    scenario = simulation.scenario
    if scenario.grid is None:
        return None
    if scenario.grid.raster is not None:
        return scenario.grid.values()
    for index, record in enumerate(scenario.objects):
        if record.shape.name == "map":
            cells = simulation.state.cells(world * simulation.objects + index)
            assert cells is not None
            return cells.occupied.astype(np.float64) * 100.0
    return np.zeros(scenario.grid.size)


class ObstacleMap(ObjectView):
    """All occupied cells as one obstacle of shape ``map``, in no group."""

    @property
    def cells(self) -> core.OccupancyGrid:
        """The grid as the engine has it."""
        cells = self._simulation.state.cells(self.row)
        assert cells is not None
        return cells

    @property
    def grid_map(self) -> Floats:
        """(nx, ny) occupancies, 0 to 100; i counts along +x, j along +y."""
        values = grid_values(self._simulation, self.world)
        assert values is not None
        return values

    @property
    def grid_reso(self) -> Floats:
        """(2, 1) extent of a cell along x and y [m]."""
        return column(self.cells.cell)

    @property
    def world_offset(self) -> list[float]:
        """[x, y] of the lower left corner [m]."""
        return list(self.cells.origin)

    @property
    def linestrings(self) -> list[Any]:
        """The outline of the occupied cells: closed shapely LineStrings, straight runs in one piece."""
        import shapely

        return [shapely.LineString(np.concatenate([ring, ring[:1]])) for ring in self.cells.outline()]

    @cached_property
    def geometry_tree(self) -> Any:
        """A shapely STRtree of ``linestrings``."""
        import shapely

        return shapely.STRtree(self.linestrings)

    def check_grid_collision(self, geometry: Any) -> bool:
        """Whether a shapely geometry meets an occupied cell; touching counts.

        Args:
            geometry: In the world frame [m].
        """
        grid = self.cells
        return grid_collision_geometry(grid.occupied * 100, grid.cell, geometry, grid.origin)

    def is_collision(self, geometry: Any) -> bool:
        """The same: cells are closed squares, so their outline adds nothing."""
        return self.check_grid_collision(geometry)
