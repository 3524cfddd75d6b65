"""Returns the objects of a world; they are made once and kept with their simulation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.objects.view import ObjectView

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["views"]


def views(simulation: Simulation, world: int = 0) -> list[ObjectView]:
    """Return the objects of one world, in the order of their rows; objects of an environment have old names, too."""
    if simulation.make_view is None:
        simulation.make_view = ObjectView
    return simulation.views(world)
