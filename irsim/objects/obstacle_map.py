"""The map of a world as an object of scripts: a static obstacle with a grid."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.common.arrays import Floats
from irsim.objects.base import column
from irsim.objects.view import ObjectView
from irsim.simulation.occupancy import grid_collision_geometry

if TYPE_CHECKING:
    import irsim._core as core
    from irsim.simulation.simulation import Simulation

__all__ = ["ObstacleMap", "grid_values"]


def grid_values(simulation: Simulation, world: int = 0) -> Floats | None:
    """Return the occupancies of the map of one world, (nx, ny), from 0 to 100; None without a map."""
    scenario = simulation.scenario
    if scenario.grid is None:
        return None
    if scenario.grid.raster is not None:
        return scenario.grid.values()
    for index, record in enumerate(scenario.objects):
        if record.is_map:
            cells = simulation.state.cells(world * simulation.objects + index)
            assert cells is not None
            return cells.occupied.astype(np.float64) * 100.0
    return np.zeros(scenario.grid.size)


class ObstacleMap(ObjectView):
    """All occupied cells as one obstacle of shape ``map``, in no group."""

    @property
    def cells(self) -> core.OccupancyGrid:
        """The grid of the engine."""
        cells = self._simulation.state.cells(self.row)
        assert cells is not None
        return cells

    @property
    def grid_map(self) -> Floats:
        """Occupancies (nx, ny), from 0 to 100; the first index counts along +x, the second along +y."""
        values = grid_values(self._simulation, self.world)
        assert values is not None
        return values

    @property
    def grid_reso(self) -> Floats:
        """Extent of a cell along x and y, (2, 1) [m]."""
        return column(self.cells.cell)

    @property
    def world_offset(self) -> list[float]:
        """[x, y] of the lower left corner [m]."""
        return list(self.cells.origin)

    @property
    def linestrings(self) -> list[Any]:
        """Outline of the occupied cells as closed shapely LineStrings without vertices on straight edges."""
        import shapely

        return [shapely.LineString(np.concatenate([ring, ring[:1]])) for ring in self.cells.outline()]

    @cached_property
    def geometry_tree(self) -> Any:
        """A shapely STRtree of ``linestrings``."""
        import shapely

        return shapely.STRtree(self.linestrings)

    def check_grid_collision(self, geometry: Any) -> bool:
        """Return whether a shapely geometry intersects or touches an occupied cell.

        Args:
            geometry: The geometry in the world frame [m].
        """
        grid = self.cells
        return grid_collision_geometry(grid.occupied * 100, grid.cell, geometry, grid.origin)

    def is_collision(self, geometry: Any) -> bool:
        """Return whether a shapely geometry intersects or touches an occupied cell."""
        return self.check_grid_collision(geometry)
