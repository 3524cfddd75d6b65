"""The environment seen in three dimensions: the same flat simulation, drawn in space."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.env.env_base import Env
from irsim.env.parameters import WorldView

if TYPE_CHECKING:
    from irsim.rendering.env_plot import EnvPlot
    from irsim.simulation.simulation import Simulation

__all__ = ["EnvBase3D", "World3D"]

_DEPTH = 10.0


class World3D(WorldView):
    """The world with an extent along z."""

    depth: float

    def __init__(self, simulation: Simulation) -> None:
        super().__init__(simulation)
        self.__dict__.update(depth=float(simulation.scenario.world.depth or _DEPTH), offset=[*self.offset[:2], 0.0])

    @property
    def z_range(self) -> list[float]:
        """[zmin, zmax] of the world [m]."""
        return [self.offset[2], self.offset[2] + self.depth]


class EnvBase3D(Env):
    """An environment with ``projection="3d"``: objects stand on the ground of a view in space."""

    _world: World3D

    def _view_of_world(self, simulation: Simulation) -> World3D:
        return World3D(simulation)

    def _new_plot(self) -> EnvPlot:
        from irsim.rendering.env_plot3d import EnvPlot3D

        return EnvPlot3D(self, depth=self._world.depth, display=self.display, full=self.full, attach=self._attach)
