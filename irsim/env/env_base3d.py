"""``irsim.make``, and the environment with a three-dimensional view: the same flat simulation, drawn in space."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.env.env_base import Env
from irsim.env.parameters import WorldView

if TYPE_CHECKING:
    from irsim.rendering.env_plot import EnvPlot
    from irsim.simulation.simulation import Simulation

__all__ = ["EnvBase3D", "World3D", "make"]

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
        from irsim.rendering.env_plot3d import EnvPlot3D

        return EnvPlot3D(self, depth=self._world.depth, display=self.display, full=self.full, attach=attach)


def make(
    world_name: str | Path | None = None, projection: str | None = None, step_mode: str | None = None, **kwargs: Any
) -> Env:
    """Open a scenario file as an environment.

    Args:
        world_name: YAML file; it is searched as given, beside the script, and in the current directory. By default it
            has the name of the running script with the suffix ``.yaml``.
        projection: ``"2d"`` (default) or ``"3d"``, which draws the same simulation in space.
        step_mode: ``"internal"`` or ``"external"``, in place of the value in the file.
        **kwargs: Other arguments of :class:`Env`: display, headless, save_ani, seed, strict, log_level, policy, …

    Raises:
        ScenarioNotFoundError: The file does not exist; the error lists the folders searched and similar names.
        ScenarioError: The file is not valid; the error holds every problem with its line and fix.
        TypeError: A keyword is not known.
    """
    chosen = (projection or "2d").lower()
    if chosen == "3d":
        return EnvBase3D(world_name, step_mode=step_mode, **kwargs)
    if chosen != "2d":
        raise ValueError(f"unknown projection {projection!r}: choose '2d' or '3d'")
    return Env(world_name, step_mode=step_mode, **kwargs)
