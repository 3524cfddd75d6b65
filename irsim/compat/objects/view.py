"""Objects as scripts get them: the view of the world with the names of IR-SIM 2.12, and the map as an object."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.common.arrays import Floats
from irsim.compat.objects.avoidance import OldAvoidance
from irsim.compat.objects.drawing import OldDrawing
from irsim.compat.objects.old_names import OldNames
from irsim.compat.objects.status import OldStatus
from irsim.objects.base import column
from irsim.objects.describe import grid_values
from irsim.objects.view import ObjectView
from irsim.simulation.occupancy import grid_collision_geometry

if TYPE_CHECKING:
    import irsim._core as core
    from irsim.simulation.simulation import Simulation

__all__ = ["ObstacleMap", "ScriptObject", "make_view", "views"]


class ScriptObject(OldNames, OldStatus, OldAvoidance, OldDrawing):
    """One robot or obstacle of an environment.

    It is an :class:`irsim.objects.view.ObjectView`, whose names completion offers, and has all names of 2.12 too.
    """

    def __dir__(self) -> Iterable[str]:
        return [name for name in super().__dir__() if name not in _HIDDEN]


_OLD = {name for kind in ScriptObject.__bases__ for name in vars(kind)} - vars(ObjectView).keys()
_HIDDEN = _OLD | {"description", "fov_occlusion", "state_dim", "state_shape", "vel_shape"}
"""Names that completion leaves out; :mod:`irsim.compat.names` lists them."""


class ObstacleMap(ScriptObject):
    """All occupied cells as one obstacle of shape ``map``, in no group."""

    @property
    def cells(self) -> core.OccupancyGrid:
        """The grid of the engine."""
        cells = self._simulation.state.cells(self.row)
        assert cells is not None
        return cells

    @property
    def grid_map(self) -> Floats:
        """Occupancies (nx, ny), 0 to 100, -1 where unknown; the first index counts along +x, the second along +y."""
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


def views(simulation: Simulation, world: int = 0) -> list[ScriptObject]:
    """Return the objects of one world with all names of 2.12, in the order of their rows."""
    simulation.make_view = make_view
    return simulation.views(world)


def make_view(simulation: Simulation, index: int, world: int) -> ScriptObject:
    """Make the object at an index: an :class:`ObstacleMap` for the map, otherwise a :class:`ScriptObject`."""
    scenario = simulation.scenario
    is_map = scenario.grid is not None and scenario.objects[index].is_map
    return (ObstacleMap if is_map else ScriptObject)(simulation, index, world)
