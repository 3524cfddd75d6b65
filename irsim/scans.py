"""What a script reads from a lidar: a view of its slice of the core's scan arrays."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from irsim.simulation import Simulation
    from irsim.views import ObjectView

__all__ = ["Lidar"]

Floats = NDArray[np.float64]
_MISS_MARGIN = 0.02
"""Beams whose range is within this of ``range_max`` [m] leave no point in the cloud."""


class Lidar:
    """A 2-D lidar of one object.

    Args:
        parent: The object that carries it.
        options: Validated options of the sensor.
        index: Number of the sensor among those of one world.

    Attributes:
        number: Beams; beam 0 is the rightmost (clockwise) one.
        angle_list: (number,) nominal angles in the sensor frame [rad].
        range_min, range_max: Limits of the ranges [m].
        offset: (x, y, theta) of the sensor in the body frame.
    """

    def __init__(self, simulation: Simulation, parent: ObjectView, options: Any, index: int) -> None:
        self.parent = parent
        self.obj_id = parent.id
        self.options = options
        self.sensor_type = str(options.name)
        self.range_min = float(options.range_min)
        self.range_max = float(options.range_max)
        self.angle_range = float(options.angle_range)
        self.scan_time = float(options.scan_time)
        self.noise, self.std, self.angle_std = options.noise, options.std, options.angle_std
        self.has_velocity = bool(options.has_velocity)
        self.offset = [float(v) for v in options.offset]
        self.attach(simulation, index)
        self.angle_list: Floats = simulation.state.beam_angles[self._beams].copy()
        self.angle_min, self.angle_max = float(self.angle_list[0]), float(self.angle_list[-1])
        self.angle_inc = self.angle_range / (self.number - 1) if self.number > 1 else 0.0
        self.time_inc = 0.0
        self.colors: dict[int, tuple[str, float]] = {}
        self._fixed = {
            "angle_min": self.angle_min,
            "angle_max": self.angle_max,
            "angle_increment": self.angle_inc,
            "time_increment": self.time_inc,
            "scan_time": self.scan_time,
            "range_min": self.range_min,
            "range_max": self.range_max,
            "ranges": None,
            "intensities": None,
        }

    def attach(self, simulation: Simulation, index: int) -> None:
        """Read the ``index``-th sensor of this simulation from now on."""
        self._simulation = simulation
        _, first, self.number = simulation.world.scans()[index]
        first += self.parent.world * simulation.world.beams_per_world
        self._beams = slice(first, first + self.number)
        self._ranges = simulation.ranges[self._beams]
        self._hits = simulation.hits[self._beams]
        self._valid = simulation.valid[self._beams]

    @property
    def range_data(self) -> Floats:
        """(number,) measured ranges [m]; a miss reads ``range_max``. A copy."""
        return self._ranges.copy()

    @property
    def valid(self) -> NDArray[np.bool_]:
        """(number,) whether the beam hit something within ``[range_min, range_max]``. A copy."""
        return self._valid.astype(bool)

    @property
    def hits(self) -> NDArray[np.int32]:
        """(number,) id of the object each beam hit, -1 where it hit nothing. A copy."""
        return self._simulation.ids[self._hits]

    @property
    def velocity(self) -> Floats:
        """(2, number) world velocity of what each beam hit [m/s]; zeros without ``has_velocity`` or hit."""
        result = np.zeros((2, self.number))
        if self.has_velocity:
            first = self.parent.world * self._simulation.objects
            for hit in np.unique(self._hits[self._hits >= 0]):
                result[:, self._hits == hit] = np.array(self._simulation.state.velocity_world(first + int(hit)))[
                    :, None
                ]
        return result

    @property
    def lidar_origin(self) -> Floats:
        """(3, 1) pose of the sensor in the world frame."""
        x, y, theta = self._simulation.pose[self.parent.row]
        dx, dy, turn = self.offset
        heading = (theta + turn + math.pi) % (2 * math.pi) - math.pi
        c, s = math.cos(theta), math.sin(theta)
        return np.array([[x + c * dx - s * dy], [y + s * dx + c * dy], [heading]])

    def get_scan(self) -> dict[str, Any]:
        """The scan as a dictionary; arrays are copies of your own.

        Returns:
            ``angle_min``, ``angle_max``, ``angle_increment`` [rad], ``time_increment``, ``scan_time`` [s],
            ``range_min``, ``range_max``, ``ranges`` (number,) [m], ``intensities`` None, ``velocity`` (2, number)
            [m/s], ``valid`` (number,) bool.
        """
        scan: dict[str, Any] = dict(self._fixed)
        scan["ranges"] = self._ranges.copy()
        scan["velocity"] = self.velocity
        scan["valid"] = self._valid.astype(bool)
        return scan

    def get_points(self) -> Floats | None:
        """(2, K) points of the valid hits in the sensor frame [m]; None when there is none."""
        keep = self._valid.astype(bool) & (self._ranges < self.range_max - _MISS_MARGIN)
        if not keep.any():
            return None
        ranges, angles = self._ranges[keep], self.angle_list[keep]
        return np.vstack([ranges * np.cos(angles), ranges * np.sin(angles)])

    scan_to_pointcloud = get_points

    def get_offset(self) -> list[float]:
        """[x, y, theta] of the sensor in the body frame."""
        return list(self.offset)

    def set_laser_color(self, laser_indices: Any, laser_color: str = "blue", alpha: float = 0.3) -> None:
        """Draw some beams in another colour from the next frame on.

        Args:
            laser_indices: Beam numbers.
            laser_color: Any Matplotlib colour.
            alpha: Opacity, 0 to 1.
        """
        for index in np.atleast_1d(np.asarray(laser_indices, dtype=int)):
            self.colors[int(index)] = (laser_color, alpha)
