"""Lidars as scripts use them: views of a slice of the scan arrays of the core."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.objects.base import column
from irsim.objects.sensors.drawing import draw_scan
from irsim.objects.setters import changed_options, refuse
from irsim.simulation.trace import past_poses

if TYPE_CHECKING:
    from irsim.objects.base import SimObject
    from irsim.simulation.simulation import Simulation

__all__ = ["FMCWLidar2D", "Lidar2D"]

MISS_MARGIN = 0.02
"""Distance [m] to ``range_max`` below which a range adds no point to the point cloud."""
_HIGHLIGHT = "#56B4E9"
"""Colour of beams picked out by ``set_laser_color``."""

_VELOCITY_COLORS = frozenset(
    {"zero_velocity_color", "positive_velocity_color", "negative_velocity_color", "no_hit_color"}
)
"""Drawing options of an FMCW lidar that are read as arrays."""
_FIXED = frozenset({
    "parent", "obj_id", "sensor_type", "angle_list", "angle_min", "angle_max", "angle_inc", "time_inc", "range_data",
    "valid", "hits", "velocity", "stamp", "lidar_origin", "scan_origin", "cast_angles", "state", "radial_velocity",
})  # fmt: skip
"""Attributes that cannot be set."""
_HINT = "it follows from `number`, `angle_range` and the other options, and from the scan"


class Lidar2D:
    """A 2-D lidar of one object.

    The options of the scenario may be set at run time: ``range_max``, ``number``, ``noise``, ….

    Args:
        parent: The object that carries it.
        options: Validated options of the sensor.
        index: Number of the sensor among the native ones of one world.

    Attributes:
        number: Number of beams; beam 0 is the rightmost one, and numbers increase counterclockwise.
        angle_list: Nominal angles of the beams in the sensor frame, (number,) [rad].
        angle_min, angle_max, angle_inc: First angle, last angle, and increment [rad].
        time_inc: Time from beam to beam [s] of a lidar whose `realism` has `sweep`, else 0; the last beam is taken at
            the end of the step.
        range_min, range_max: Limits of the ranges [m].
        offset: Pose of the sensor in the body frame, (3, 1): x, y [m], heading [rad].
        alpha, color: How the beams are drawn; may be changed.
        colors: {beam: (colour, alpha)} of beams drawn differently, see :meth:`set_laser_color`.
    """

    drawing: dict[str, Any] | None = None
    parent: SimObject
    obj_id: int
    sensor_type: str
    number: int
    endpoint: bool
    range_min: float
    range_max: float
    angle_range: float
    scan_time: float
    rate: float | None
    latency: float
    noise: bool
    std: float
    angle_std: float
    offset: Floats
    has_velocity: bool
    realism: Any
    angle_list: Floats
    angle_min: float
    angle_max: float
    angle_inc: float
    time_inc: float
    _simulation: Simulation
    _index: int
    _beams: slice
    _ranges: Floats
    _hits: NDArray[np.int32]
    _valid: NDArray[np.bool_]
    _velocities: Floats
    _no_velocities: Floats
    _stamps: Floats
    _settings: ClassVar[tuple[str, ...]] = (
        "number", "endpoint", "range_min", "range_max", "angle_range", "scan_time", "noise", "std", "angle_std",
        "offset", "has_velocity", "realism", "rate", "latency",
    )  # fmt: skip

    def __init__(self, simulation: Simulation, parent: SimObject, options: Any, index: int) -> None:
        self.options = options
        self.__dict__.update(parent=parent, obj_id=parent.id, sensor_type=str(options.name))
        self.alpha, self.color = options.drawn_alpha, options.drawn_color
        self.colors: dict[int, tuple[str, float]] = {}
        self._drawn: Any = None
        self.attach(simulation, index)

    def attach(self, simulation: Simulation, index: int) -> None:
        """Attach the lidar to the native sensor with this index in a simulation."""
        own, world = self.__dict__, self.parent.world  # without __setattr__: many do this at once
        _, first, number = simulation.scans[index]
        first += world * simulation.world.beams_per_world
        beams = slice(first, first + number)
        own["_simulation"], own["_index"], own["_beams"] = simulation, index, beams
        own["_ranges"], own["_hits"], own["_valid"] = (
            simulation.ranges[beams],
            simulation.hits[beams],
            simulation.valid[beams].view(np.bool_),
        )
        own["_stamps"] = simulation.state.stamp[world]
        first, rows = simulation.velocity_slices[index]
        first += world * simulation.world.velocities_per_world
        own["_velocities"] = simulation.state.velocities[first : first + rows * number].reshape(rows, number)
        if own.get("_described") is not self.options:
            self._describe(number)

    def _describe(self, number: int) -> None:
        """Set the attributes that follow from the options and the beam angles."""
        options, own = self.options, self.__dict__
        own["_described"] = options
        angles: Floats = self._simulation.state.beam_angles[self._beams].copy()
        own.update({name: getattr(options, name) for name in self._settings}, number=number, angle_list=angles)
        own["offset"] = column(options.offset)
        own["has_velocity"] = bool(options.has_velocity) and len(self._velocities) == 2
        own["angle_min"], own["angle_max"] = float(angles[0]), float(angles[-1])
        spaces = number - 1 if self.endpoint else number
        own["angle_inc"] = self.angle_range / spaces if number > 1 else 0.0
        sweeps = self.realism is not None and self.realism.sweep
        own["time_inc"] = self.scan_time * self.angle_inc / (2 * math.pi) if sweeps else 0.0
        own["_no_velocities"] = np.zeros((2, self.number))
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

    def __setattr__(self, name: str, value: Any) -> None:
        if name in self._settings:
            self._change(name, value)
        elif name in _FIXED:
            refuse(f"the {self.sensor_type} of {self.parent.name!r}", name, _HINT)
        else:
            object.__setattr__(self, name, value)

    def _change(self, name: str, value: Any) -> None:
        """Set an option for all further scans, and repeat the present scan."""
        parent, before = self.parent, self.options
        self.options = changed_options(before, f"the {self.sensor_type} of {parent.name!r}", **{name: value})
        sensors = [self.options if options is before else options for options in parent.record.sensors]
        try:
            parent.amend(replace(parent.record, sensors=sensors))
        except Exception:
            self.options = before
            raise

    @property
    def range_data(self) -> Floats:
        """Copy of the measured ranges, (number,) [m]; ``range_max`` for beams that hit nothing."""
        return self._ranges.copy()

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Copy of the flags that say whether each beam hit something within ``[range_min, range_max]``, (number,)."""
        return self._valid.copy()

    @property
    def hits(self) -> NDArray[np.int32]:
        """Copy of the ids of the objects that the beams hit, (number,); -1 for beams that hit nothing."""
        return self._simulation.ids[self._hits]

    @property
    def stamp(self) -> float:
        """Time at which the last scan that has arrived was measured [s]; NaN before the first one."""
        return float(self._stamps[self._index])

    @property
    def velocity(self) -> Floats:
        """Copy of the world velocities at the hits, (2, number) [m/s]; zeros without ``has_velocity`` or a hit."""
        return (self._velocities if self.has_velocity else self._no_velocities).copy()

    @property
    def lidar_origin(self) -> Floats:
        """Pose of the sensor in the world frame, (3, 1): x, y [m], heading [rad]."""
        return self._placed(self._simulation.pose[self.parent.row])

    @property
    def scan_origin(self) -> Floats:
        """Pose of the sensor at which it took the scan that it shows, world frame, (3, 1): x, y [m], heading [rad].

        It is the present pose of a sensor that measures in each step, before the first data, and where the environment
        does not keep the past.
        """
        simulation, row = self._simulation, self.parent.row
        if not getattr(self.options, "is_timed", False) or simulation.copies > 1 or not math.isfinite(self.stamp):
            return self.lidar_origin
        step = round(self.stamp / simulation.scenario.world.step_time)
        poses = past_poses(simulation, row)
        if poses is None or step >= len(poses) - 1 or not np.isfinite(poses[step]).all():
            return self.lidar_origin
        return self._placed(poses[step])

    @property
    def cast_angles(self) -> Floats:
        """Copy of the nominal beam angles, (number,) [rad]; their noise (``angle_std``) is drawn within each scan."""
        return self.angle_list.copy()

    @property
    def state(self) -> Floats:
        """Pose of the carrier in the world frame, (3, 1): x, y [m], heading [rad]."""
        return column(self._simulation.pose[self.parent.row])

    def init_geometry(self, state: Any) -> None:
        """Do nothing; kept for compatibility, because the engine holds the beams.

        Args:
            state: Ignored.
        """

    def step(self, state: Any = None) -> None:
        """Take a new scan, which arrives at once, whatever `rate` and `latency` say.

        Args:
            state: Pose of the carrier, x, y [m] and heading [rad], in any shape; by default the present one.
        """
        pose = self._simulation.pose[self.parent.row] if state is None else np.asarray(state, dtype=np.float64)
        x, y, theta = (float(v) for v in pose.reshape(-1)[:3])
        core.scan(self._simulation.world, self._simulation.state, self.parent.world, self._index, (x, y, theta))

    def get_scan(self) -> dict[str, Any]:
        """Return the scan as a dictionary; its arrays are copies.

        Returns:
            ``angle_min``, ``angle_max``, ``angle_increment`` [rad], ``time_increment``, ``scan_time`` [s],
            ``range_min``, ``range_max``, ``ranges`` (number,) [m], ``intensities`` None, ``velocity`` (2, number)
            [m/s], ``valid`` (number,) bool; with a `rate` or a `latency` also ``stamp`` [s].
        """
        velocity = (self._velocities if self.has_velocity else self._no_velocities).copy()
        scan = {"ranges": self._ranges.copy(), "velocity": velocity, "valid": self._valid.copy()}
        return {**self._fixed, **scan, **self._age()}

    def _age(self) -> dict[str, float]:
        """The key ``stamp`` of a scan that may be old; other scans have the keys of IR-SIM 2.12."""
        return {"stamp": self.stamp} if self.options.is_timed else {}

    def get_points(self) -> Floats | None:
        """Return the points of the valid hits in the sensor frame, (2, K) [m]; None without a hit."""
        keep = self._valid & (self._ranges < self.range_max - MISS_MARGIN)
        if not keep.any():
            return None
        ranges, angles = self._ranges[keep], self.angle_list[keep]
        return np.vstack([ranges * np.cos(angles), ranges * np.sin(angles)])

    scan_to_pointcloud = get_points

    def get_offset(self) -> list[float]:
        """Return the pose [x, y, theta] of the sensor in the body frame [m, m, rad]."""
        return [float(v) for v in self.offset[:, 0]]

    def set_laser_color(self, laser_indices: Any, laser_color: str | None = None, alpha: float = 0.3) -> None:
        """Draw some beams in another colour from the next frame on.

        Args:
            laser_indices: Beam numbers.
            laser_color: Any Matplotlib colour; by default light blue.
            alpha: Opacity, 0 to 1.
        """
        for index in np.atleast_1d(np.asarray(laser_indices, dtype=int)):
            self.colors[int(index)] = (laser_color or _HIGHLIGHT, alpha)

    # drawing by hand: environments draw their lidars by themselves --------------------------------------------------
    def plot(self, ax: Any, state: Any = None, **kwargs: Any) -> None:
        """Draw the beams into axes.

        Args:
            ax: Matplotlib axes in world coordinates.
            state: Pose of the carrier; by default the present one.
            **kwargs: ``alpha`` and ``color`` of the beams.
        """
        from irsim.graphics.figure.layers import BeamLayer

        self.plot_clear()
        self.alpha, self.color = kwargs.get("alpha", self.alpha), kwargs.get("color", self.color)
        self._drawn = BeamLayer(ax, 2)
        self._show(state)

    def step_plot(self) -> None:
        """Update what ``plot`` has drawn."""
        if self._drawn is not None:
            self._show(None)

    def plot_clear(self) -> None:
        """Remove what ``plot`` has drawn."""
        if self._drawn is not None:
            self._drawn.remove()
        self._drawn = None

    def _show(self, state: Any) -> None:
        origin = None if state is None else self._placed(np.asarray(state, dtype=np.float64).reshape(-1)[:3])
        self._drawn.show(draw_scan(self, origin=origin))

    def _placed(self, carrier: Floats) -> Floats:
        """Return the pose of the sensor on a carrier at this pose, (3, 1), in the world frame."""
        x, y, theta = carrier
        dx, dy, turn = self.offset[:, 0]
        heading = (theta + turn + math.pi) % (2 * math.pi) - math.pi
        c, s = math.cos(theta), math.sin(theta)
        return np.array([[x + c * dx - s * dy], [y + s * dx + c * dy], [heading]])


class FMCWLidar2D(Lidar2D):
    """A lidar that also measures the radial velocity of each hit.

    The drawing options of the scenario (``velocity_color``, ``velocity_linewidth``, …) are attributes, too; a write
    shows in the next frame. Colours are read as arrays of red, green and blue, (3,) from 0 to 1, and may be set in any
    form that Matplotlib knows; ``velocity_marker_edge_color`` stays as it is written.

    Attributes:
        motion_compensate: Whether the motion of the carrier is subtracted from the radial velocities.
        velocity_noise_std: Standard deviation of the noise of the radial velocities [m/s].
        drawing: Drawing options by name; may be changed.
    """

    drawing: dict[str, Any]
    motion_compensate: bool
    velocity_noise_std: float
    _settings: ClassVar[tuple[str, ...]] = (*Lidar2D._settings, "motion_compensate", "velocity_noise_std")

    def __init__(self, simulation: Simulation, parent: SimObject, options: Any, index: int) -> None:
        super().__init__(simulation, parent, options, index)
        self.drawing: dict[str, Any] = options.drawing()

    def __getattr__(self, name: str) -> Any:
        drawing = self.__dict__.get("drawing", {})
        if name in _VELOCITY_COLORS and name in drawing:
            from matplotlib.colors import to_rgb

            return np.array(to_rgb(drawing[name]))
        if name in drawing:
            return drawing[name]
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def __setattr__(self, name: str, value: Any) -> None:
        drawing = self.__dict__.get("drawing", {})
        if name in drawing:
            drawing[name] = self._drawable(name, value)
        else:
            super().__setattr__(name, value)

    def _drawable(self, name: str, value: Any) -> Any:
        """Return a drawing option that is to be written, after a check.

        Raises:
            ValueError: The value is not valid.
        """
        plain = tuple(value.tolist()) if isinstance(value, np.ndarray) else value
        changed_options(self.options, f"the {self.sensor_type} of {self.parent.name!r}", **{name: plain})
        return plain

    @property
    def radial_velocity(self) -> Floats:
        """Copy of the radial velocities of valid hits, (number,) [m/s], positive when receding; 0 for other beams."""
        velocity: Floats = self._velocities[0].copy()
        return velocity

    def get_scan(self) -> dict[str, Any]:
        """Return the scan as a dictionary, with ``radial_velocity`` (number,) [m/s] in place of ``velocity``."""
        scan = {"ranges": self._ranges.copy(), "radial_velocity": self._velocities[0].copy()}
        return {**self._fixed, **scan, "valid": self._valid.copy(), **self._age()}
