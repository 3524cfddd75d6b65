"""The share of the area of the world that the robots have seen."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["explored_share"]


def explored_share(simulation: Simulation, world: int = 0) -> float | None:
    """Share of the cells of the fog that the robots have seen, from 0 to 1; None without ``fog_map``.

    The fog covers the whole world, so the insides of obstacles, which no robot sees, count in full.
    """
    cells = simulation.state.explored[world]
    return float(np.count_nonzero(cells)) / cells.size if cells.size else None
