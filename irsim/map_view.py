"""The map as scripts see it: one more static obstacle, with its grid."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irsim.body import column
from irsim.views import ObjectView

if TYPE_CHECKING:
    from irsim import _core as core
    from irsim.simulation import Simulation

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
        import shapely

        grid = self.cells
        (x, y), (dx, dy), (nx, ny) = grid.origin, grid.cell, grid.shape
        if geometry.is_empty:
            return False
        low_x, low_y, high_x, high_y = geometry.bounds
        # one cell more on every side: whether an edge touches is decided exactly below
        i0, i1 = (int(np.clip(np.floor((v - x) / dx), -1, nx)) for v in (low_x, high_x))
        j0, j1 = (int(np.clip(np.floor((v - y) / dy), -1, ny)) for v in (low_y, high_y))
        i0, j0 = max(i0 - 1, 0), max(j0 - 1, 0)
        i, j = np.nonzero(grid.occupied[i0 : i1 + 2, j0 : j1 + 2])
        i, j = i + i0, j + j0
        boxes = shapely.box(x + i * dx, y + j * dy, x + (i + 1) * dx, y + (j + 1) * dy)
        shapely.prepare(geometry)
        return bool(shapely.intersects(geometry, boxes).any())

    def is_collision(self, geometry: Any) -> bool:
        """The same: cells are closed squares, so their outline adds nothing."""
        return self.check_grid_collision(geometry)
