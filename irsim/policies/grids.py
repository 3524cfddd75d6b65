"""The static objects of worlds as grids, made once for all worlds in which they are equal."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.common.outline import outline
from irsim.simulation.build import static_shapes_are_random

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["MAX_CELLS", "GridMap", "Grids"]

MAX_CELLS = 4_000_000
"""Largest number of cells of a grid; larger worlds get larger cells."""


@dataclass(frozen=True)
class GridMap:
    """The static objects of a world as a grid, see :class:`irsim.policies.Map`."""

    occupied: NDArray[np.bool_]
    origin: tuple[float, float]
    resolution: float


class Grids:
    """The grids of the worlds of a simulation, kept until static objects change.

    Args:
        simulation: The simulation.
        resolution: Side of a cell [m].
    """

    def __init__(self, simulation: Simulation, resolution: float) -> None:
        self._simulation = simulation
        self._resolution = resolution
        self._revision = -1
        self._static: NDArray[np.int64] = np.zeros(0, dtype=np.int64)
        self._random = False
        self._keys: NDArray[np.uint64] | None = None
        self._maps: list[GridMap] = []

    def of(self, worlds: NDArray[np.int64]) -> tuple[GridMap, ...]:
        """The grid of each of these worlds; equal worlds share one."""
        self._update()
        return tuple([self._maps[world] for world in worlds.tolist()])

    def _update(self) -> None:
        simulation = self._simulation
        if simulation.revision != self._revision:
            records = simulation.scenario.objects
            static = [i for i, record in enumerate(records) if record.static and not record.unobstructed]
            self._static, self._random = np.array(static, dtype=np.int64), static_shapes_are_random(simulation.scenario)
            self._revision, self._keys, self._maps = simulation.revision, None, []
        keys = self._signatures()
        if self._keys is not None and np.array_equal(keys, self._keys):
            return
        unique, first, number = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        before: dict[bytes, GridMap] = {}
        if self._keys is not None:
            before = {key.tobytes(): made for key, made in zip(self._keys, self._maps, strict=True)}
        made = [
            before.get(key.tobytes()) or self._make(world) for key, world in zip(unique, first.tolist(), strict=True)
        ]
        self._keys, self._maps = keys, [made[k] for k in number.reshape(-1).tolist()]

    def _signatures(self) -> NDArray[np.uint64]:
        """(W, n) numbers that are equal for worlds with equal static objects."""
        simulation = self._simulation
        poses = simulation.pose.reshape(simulation.copies, simulation.objects, 3)[:, self._static]
        parts = [np.ascontiguousarray(poses).view(np.uint64).reshape(simulation.copies, -1)]
        if self._random:
            state = simulation.state
            parts += [state.seed[:, None], state.scene.astype(np.uint64)[:, None]]
        return np.concatenate([*parts, np.zeros((simulation.copies, 1), dtype=np.uint64)], axis=1)

    def _make(self, world: int) -> GridMap:
        simulation = self._simulation
        x0, y0, x1, y1 = simulation.scenario.world.bounds
        side = max(self._resolution, math.sqrt((x1 - x0) * (y1 - y0) / MAX_CELLS))
        nx, ny = (max(1, math.ceil(round(extent / side, 6))) for extent in (x1 - x0, y1 - y0))
        things: list[tuple[list[Any], tuple[float, float, float]]] = [
            (outline(simulation.state, world * simulation.objects + index, world_frame=True).core(), (0.0, 0.0, 0.0))
            for index in self._static.tolist()
        ]
        terrain = core.Terrain((x0 - side, y0 - side, x0 + (nx + 1) * side, y0 + (ny + 1) * side), things)
        free = terrain.open_cells([], 0.0, ((x0, y0), (side, side), nx, ny))
        return GridMap(free == 0, (x0, y0), side)
