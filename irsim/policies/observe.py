"""Observations of chosen robots in all worlds of a simulation, computed for all of them at once."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.options.registry import SENSORS
from irsim.policies.grids import Grids
from irsim.policies.observations import Neighbors, Observations, Scan

if TYPE_CHECKING:
    from irsim.common.arrays import Floats
    from irsim.policies.policy import Needs
    from irsim.simulation.simulation import Simulation

__all__ = ["Beams", "Observer", "beams_of"]


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


class Observer:
    """Observes robots of a simulation; made again when objects are added, removed or changed.

    Args:
        simulation: The simulation.
        needs: What is observed besides the robots themselves.
        robots: (n,) indices, within a world, of the robots that may be observed. For scans all have equal lidars.

    Attributes:
        looking: What is observed, for the core.
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
        """What these robots observe now.

        Args:
            rows: (B,) their rows.
            first: (B,) whether each has not decided yet in this episode.
            slot: (B,) index of the world of each, as the policy knows it.
        """
        simulation, needs = self._simulation, self._needs
        world, robot = np.divmod(rows, simulation.objects)
        step_time = float(simulation.scenario.world.step_time)
        return Observations(
            world=slot,
            robot=simulation.ids[robot].astype(np.int64),
            first=first,
            time=simulation.count[world].astype(np.float64) * step_time,
            step_time=step_time,
            pose=simulation.pose[rows],
            steering=np.where(self._steered[robot], simulation.extra[rows, 0], 0.0),
            velocity=simulation.twist[rows, :2],
            yaw_rate=simulation.twist[rows, 2],
            control=simulation.control[rows],
            goal=simulation.goal[rows],
            goal_threshold=self._threshold[robot],
            radius=simulation.radius[rows],
            low=simulation.state.vel_min[rows],
            high=simulation.state.vel_max[rows],
            arrived=simulation.arrived[rows].astype(bool),
            neighbors=self._neighbors(rows) if needs.neighbors > 0 else None,
            scan=self._scan(world, robot) if needs.scan else None,
            maps=None if self._grids is None else self._grids.of(world),
            commanded=simulation.state.commanded[rows],
        )

    def _neighbors(self, rows: NDArray[np.int64]) -> Neighbors:
        simulation = self._simulation
        found = core.find_neighbors(simulation.world, simulation.state, self.looking, rows)
        mask, index, position, heading, velocity, radius, arrived, robot, extent, own_extent = found
        measured = self._needs.neighbor_extents
        return Neighbors(
            mask.view(bool), index, position, heading, velocity, radius, arrived.view(bool), robot.view(bool),
            extent=extent if measured else None, own_extent=own_extent if measured else None,
        )  # fmt: skip

    def _scan(self, world: NDArray[np.int64], robot: NDArray[np.int64]) -> Scan:
        simulation, beams = self._simulation, self._beams
        assert beams is not None, "the driver checks that every robot has a lidar"
        start = world * simulation.world.beams_per_world + self._first_beam[robot]
        ranges = simulation.ranges[start[:, None] + np.arange(len(beams.angles))]
        return Scan(ranges=ranges, angles=beams.angles, range_max=beams.range_max, position=beams.position)
