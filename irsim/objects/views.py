"""Returns the objects of a world for scripts; they are made once and kept with their simulation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.objects.obstacle_map import ObstacleMap
from irsim.objects.view import ObjectView

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["make_view", "views"]


def views(simulation: Simulation, world: int = 0) -> list[ObjectView]:
    """Return the objects of one world, in the order of their rows."""
    simulation.make_view = make_view
    return simulation.views(world)


def make_view(simulation: Simulation, index: int, world: int) -> ObjectView:
    """Make the object at an index of a world: an :class:`ObstacleMap` for the map, otherwise an :class:`ObjectView`."""
    is_map = simulation.scenario.objects[index].is_map
    return (ObstacleMap if is_map else ObjectView)(simulation, index, world)
