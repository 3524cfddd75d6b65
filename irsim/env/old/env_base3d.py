"""The environment of IR-SIM 2.12 with a three-dimensional view: the same flat simulation, drawn in space."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from irsim.env.env_base import Env
from irsim.env.parameters import WorldView

if TYPE_CHECKING:
    from irsim.env.old.env_plot import EnvPlot
    from irsim.simulation.simulation import Simulation

__all__ = ["EnvBase3D", "World3D"]

DEFAULT_DEPTH = 10.0
"""Extent [m] along z of a world whose scenario gives no ``depth``."""


class World3D(WorldView):
    """The world with an extent along z."""

    depth: float

    def __init__(self, simulation: Simulation) -> None:
        super().__init__(simulation)
        self.__dict__.update(
            depth=float(simulation.scenario.world.depth or DEFAULT_DEPTH), offset=[*self.offset[:2], 0.0]
        )

    @property
    def z_range(self) -> list[float]:
        """[zmin, zmax] of the world [m]."""
        return [self.offset[2], self.offset[2] + self.depth]


class EnvBase3D(Env):
    """An environment with ``projection="3d"``: it is drawn in space, with the objects on the ground."""

    _world: World3D
    _world_class = World3D

    def _make_plot(self, attach: Callable[[Any], None]) -> EnvPlot:
        from irsim.env.old.env_plot3d import EnvPlot3D

        return EnvPlot3D(self, depth=self._world.depth, display=self.display, full=self.full, attach=attach)
