"""Observations of learners, as one row of numbers each."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.learning.tasks.files import TaskError
from irsim.policies.fit import lidar_problem
from irsim.policies.networks.layout import Layout, layout_bounds, layout_needs, layout_shapes, observe
from irsim.policies.observe import Observer

if TYPE_CHECKING:
    from irsim.learning.draws import Draws
    from irsim.simulation.simulation import Simulation

__all__ = ["Eyes"]


class Eyes:
    """Writes the parts of a layout one after the other into rows of single precision.

    The numbers are the ones that a network with the same layout observes. Sets are written member by member; absent
    members are zeros.

    Args:
        simulation: The simulation.
        layout: The parts.
        indices: (A,) indices of the learners in a world.
        threads: Number of threads.
        draws: Draws that are observed at the end.

    Attributes:
        size: Number of numbers of an observation, D.
        parts: Label of each part -> its columns, and its shape.
        drawn: Columns of the draws that are observed.
        low, high: (D,) bounds.
        native: Options for the core of the parts that it observes, and the column at which each begins.

    Raises:
        TaskError: A learner lacks the lidar that a part needs.
    """

    def __init__(
        self, simulation: Simulation, layout: Layout, indices: NDArray[np.int64], threads: int, draws: Draws
    ) -> None:
        self._simulation, self._layout, self._threads = simulation, layout, threads
        needs = layout_needs(layout)
        problem = lidar_problem(needs, simulation, indices.tolist())
        if problem is not None:
            raise TaskError(f"the observation {problem[0]}", problem[1])
        self._observer = Observer(simulation, needs, indices)
        self.parts: dict[str, tuple[slice, tuple[int, ...]]] = {}
        low, high, column = [], [], 0
        native: list[tuple[object, int]] = []
        bounds, shapes = layout_bounds(layout), layout_shapes(layout)
        for part, kernel in zip(layout.parts, layout.kernels, strict=True):
            shape = shapes[part.key]
            size = shape.features * (1 if shape.members is None else shape.members)
            sides = (shape.features,) if shape.members is None else (shape.members, shape.features)
            self.parts[part.key] = slice(column, column + size), sides
            low.append(bounds[part.key][0].reshape(-1))
            high.append(bounds[part.key][1].reshape(-1))
            if kernel is not None and part.name != "map":
                native.append((kernel, column))
            column += size
        self._draws, self._facts = draws, np.zeros((0, 0), dtype=np.float32)
        self.drawn = slice(column, column + draws.size)
        starts = np.arange(simulation.copies, dtype=np.int64)[:, None] * simulation.objects
        self._slot = np.zeros(simulation.copies * simulation.objects, dtype=np.int64)
        self._slot[(starts + indices).reshape(-1)] = np.arange(simulation.copies * len(indices))
        low.append(np.zeros(draws.size))
        high.append(np.ones(draws.size))
        self.size = column + draws.size
        self.low = np.concatenate(low).astype(np.float32)
        self.high = np.concatenate(high).astype(np.float32)
        self.native = native
        self._all_native = len(native) == len(layout.parts)

    def observe(self, rows: NDArray[np.int64], out: NDArray[np.float32] | None = None) -> NDArray[np.float32]:
        """(B, D) what learners observe now.

        Args:
            rows: (B,) their rows.
            out: (B, D) array that is filled and returned; None: a new one.
        """
        seen = np.empty((len(rows), self.size), dtype=np.float32) if out is None else out
        simulation = self._simulation
        core.observe_rows(simulation.world, simulation.state, self.looking, self.native, rows, seen, self._threads)
        self.complete(rows, seen)
        return seen

    @property
    def looking(self) -> core.Looking:
        """The core's observation of other objects."""
        return self._observer.looking

    def complete(self, rows: NDArray[np.int64], seen: NDArray[np.float32]) -> None:
        """Write the parts of (B, D) observations that the core has not written: those besides :attr:`native`."""
        if not self._all_native:
            self._observe_others(rows, seen)
        if self._draws.size:
            seen[:, self.drawn] = self._facts[self._slot[rows]]

    def read_draws(self) -> None:
        """Find out what was drawn for the present episodes."""
        if self._draws.size:
            self._facts = self._draws.observed()

    def _observe_others(self, rows: NDArray[np.int64], seen: NDArray[np.float32]) -> None:
        """Parts that the core does not observe in bulk: pictures of maps, and parts in Python."""
        done = {column for _, column in self.native}
        there = self._simulation.appeared[rows] >= 0
        rows = rows[there]
        first, world = np.zeros(len(rows), dtype=bool), rows // self._simulation.objects
        observed = observe(self._layout, self._observer.observe(rows, first, world)) if len(rows) else {}
        for label, (columns, _) in self.parts.items():
            if columns.start in done:
                continue
            seen[~there, columns] = 0.0
            if observed:
                seen[there, columns] = observed[label].flat()
