"""Observations of chosen robots in all worlds of a simulation: lidars, neighbors and maps, for all robots at once."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.common.outline import outline
from irsim.options.registry import SENSORS
from irsim.policies.observations import Neighbors, Observations, Scan
from irsim.simulation.build import static_shapes_are_random

if TYPE_CHECKING:
    from irsim.common.arrays import Floats
    from irsim.policies.policy import Needs
    from irsim.simulation.simulation import Simulation

__all__ = ["MAX_CELLS", "Beams", "GridMap", "Grids", "Observer", "beams_of"]

MAX_CELLS = 4_000_000
"""Largest number of cells of a grid; larger worlds get larger cells."""


class Beams:
    """Where the first lidar of an object is among the beams of its world.

    Attributes:
        first: Its first beam.
        angles: (n,) direction of each beam in the frame of the object [rad].
        range_max: Largest range [m].
        position: (2,) where the lidar is in the frame of the object [m].
    """

    def __init__(self, first: int, angles: Floats, range_max: float, position: Floats) -> None:
        self.first, self.angles, self.range_max, self.position = first, angles, range_max, position

    def equal(self, other: Beams) -> bool:
        """Whether both lidars have the same beams."""
        return np.array_equal(self.angles, other.angles) and self.range_max == other.range_max


def beams_of(simulation: Simulation, index: int) -> Beams | None:
    """The first native lidar of an object; None without one."""
    number = next((k for k, (owner, _, _) in enumerate(simulation.scans) if owner == index), None)
    if number is None:
        return None
    _, first, count = simulation.scans[number]
    options: Any = next(s for s in simulation.scenario.objects[index].sensors if _is_native(s))
    angles = simulation.state.beam_angles[first : first + count] + float(options.offset[2])
    return Beams(first, angles, float(options.range_max), np.array(options.offset[:2], dtype=np.float64))


def _is_native(sensor: Any) -> bool:
    feature = SENSORS.get(str(getattr(sensor, "name", "")))
    return feature is not None and feature.kernel is not None


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


class Observer:
    """Observes robots of a simulation; made again when objects are added, removed or changed.

    Args:
        simulation: The simulation.
        needs: Observations besides the robots themselves.
        robots: (n,) indices, within a world, of the robots that may be observed. For scans all have equal lidars.

    Attributes:
        looking: The observations to make, for the core.
    """

    def __init__(self, simulation: Simulation, needs: Needs, robots: NDArray[np.int64]) -> None:
        self._simulation, self._needs = simulation, needs
        records = simulation.scenario.objects
        self._threshold = np.array([record.goal_threshold for record in records], dtype=np.float64)
        self._steered = np.array([bool(getattr(record.kinematics, "steered", False)) for record in records])
        self._first_beam = np.zeros(len(records), dtype=np.int64)
        self._beams: Beams | None = None
        if needs.scan:
            for index in robots.tolist():
                self._beams = beams_of(simulation, index)
                self._first_beam[index] = 0 if self._beams is None else self._beams.first
        self.looking = self._look()
        self._grids = Grids(simulation, needs.map_resolution) if needs.map else None

    def _look(self) -> core.Looking:
        needs, beams = self._needs, self._beams
        return core.Looking(
            neighbors=needs.neighbors,
            reach=needs.neighbor_range,
            statics=needs.static_neighbors,
            extents=needs.neighbor_extents,
            steered=self._steered.tolist(),
            first_beam=self._first_beam.tolist(),
            beams=0 if beams is None else len(beams.angles),
            range_max=0.0 if beams is None else beams.range_max,
        )

    def observe(self, rows: NDArray[np.int64], first: NDArray[np.bool_], slot: NDArray[np.int64]) -> Observations:
        """Observations of these robots now.

        Args:
            rows: (B,) their rows.
            first: (B,) whether each has not decided yet in this episode.
            slot: (B,) world index of each, as passed to the policy.
        """
        simulation, needs = self._simulation, self._needs
        world, robot = np.divmod(rows, simulation.objects)
        step_time = float(simulation.scenario.world.step_time)
        pose, velocity, arrived = core.believed_rows(simulation.world, simulation.state, rows)
        return Observations(
            world=slot,
            robot=simulation.ids[robot].astype(np.int64),
            first=first,
            time=simulation.count[world].astype(np.float64) * step_time,
            step_time=step_time,
            pose=pose,
            steering=np.where(self._steered[robot], simulation.extra[rows, 0], 0.0),
            velocity=velocity,
            yaw_rate=simulation.twist[rows, 2],
            control=simulation.control[rows],
            goal=simulation.goal[rows],
            goal_threshold=self._threshold[robot],
            radius=simulation.radius[rows],
            low=simulation.state.vel_min[rows],
            high=simulation.state.vel_max[rows],
            arrived=arrived.astype(bool),
            neighbors=self._neighbors(rows) if needs.neighbors > 0 else None,
            scan=self._scan(world, robot) if needs.scan else None,
            maps=None if self._grids is None else self._grids.of(world),
            commanded=simulation.state.commanded[rows],
        )

    def _neighbors(self, rows: NDArray[np.int64]) -> Neighbors:
        simulation = self._simulation
        result = core.find_neighbors(simulation.world, simulation.state, self.looking, rows)
        mask, index, position, heading, velocity, radius, arrived, robot, extent, own_extent = result
        measured = self._needs.neighbor_extents
        pose = np.concatenate([position, heading[..., None]], axis=-1)
        return Neighbors(
            pose, velocity, radius, arrived.view(bool), mask.view(bool), index, robot.view(bool),
            extent=extent if measured else None, own_extent=own_extent if measured else None,
        )  # fmt: skip

    def _scan(self, world: NDArray[np.int64], robot: NDArray[np.int64]) -> Scan:
        simulation, beams = self._simulation, self._beams
        assert beams is not None, "the driver checks that every robot has a lidar"
        start = world * simulation.world.beams_per_world + self._first_beam[robot]
        ranges = simulation.ranges[start[:, None] + np.arange(len(beams.angles))]
        return Scan(ranges=ranges, angles=beams.angles, range_max=beams.range_max, position=beams.position)
