"""How soon learners would touch others with the velocities that they command."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.policies.networks.layout import Layout
from irsim.policies.networks.parts.rvo_cones import RvoCones
from irsim.policies.observe import Observer

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["Threats"]

_URGENCY = 7
"""Number of the urgency among those of a cone."""


class Threats:
    """The urgency of the most urgent velocity obstacle of each learner, see the observation part ``rvo_cones``.

    Args:
        simulation: The simulation.
        indices: (A,) indices of the learners in a world.
        threads: Number of threads.
    """

    def __init__(self, simulation: Simulation, indices: NDArray[np.int64], threads: int) -> None:
        part = RvoCones(count=1, decimals=None)
        self._simulation, self._threads = simulation, threads
        self._looking = Observer(simulation, part.needs(), indices).looking
        self._kernel = Layout(parts=[part]).kernels[0]

    def urgency(self, rows: NDArray[np.int64]) -> Floats:
        """(B,) 1 / (t + 0.2 s), with the time t to the first touch; 0 if there is none within 5 s."""
        found = np.empty((len(rows), _URGENCY + 1), dtype=np.float32)
        world, state = self._simulation.world, self._simulation.state
        core.observe_rows(world, state, self._looking, [(self._kernel, 0)], rows, found, self._threads)
        return found[:, _URGENCY].astype(np.float64)
