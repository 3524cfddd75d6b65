"""ROS 2 messages made from numbers, and their CDR; rosbags makes the classes from the definitions."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.common.extras import require

__all__ = ["MAX_SEQUENCE", "Messages"]

MAX_SEQUENCE = 1_000_000
"""Longest sequence of a message from outside; a count in a message is never trusted beyond it."""


class Messages:
    """Makes messages from numbers. Positions are in m, angles in rad, times in ns; the plane is z = 0.

    Args:
        distro: The release of ROS 2 whose definitions are used; they differ in what DDS nodes tell each other.
        extra: The extra that is named if rosbags is missing.

    Attributes:
        store: Type store of rosbags.
        gid_size: Length of an identifier in ``rmw_dds_common/msg/Gid`` [bytes].
    """

    def __init__(self, distro: Literal["humble", "jazzy"] = "humble", extra: str = "bag") -> None:
        require(extra, "rosbags")
        from rosbags.typesys import Stores, get_typestore

        self.store = get_typestore(Stores.ROS2_HUMBLE if distro == "humble" else Stores.ROS2_JAZZY)
        self.gid_size = 24 if distro == "humble" else 16
        self.store.max_sequence_length = MAX_SEQUENCE
        self._types = self.store.types
        self._covariance = np.zeros(36)
        self._no_intensities = np.zeros(0, dtype=np.float32)
        self.point, self.quaternion = self("geometry_msgs", "Point"), self("geometry_msgs", "Quaternion")
        self._pose, self._vector = self("geometry_msgs", "Pose"), self("geometry_msgs", "Vector3")
        self._time, self._header = self("builtin_interfaces", "Time"), self("std_msgs", "Header")
        self._transform = self("geometry_msgs", "Transform")
        self._stamped_transform = self("geometry_msgs", "TransformStamped")
        self._odometry, self._twist = self("nav_msgs", "Odometry"), self("geometry_msgs", "Twist")
        self._sure_pose = self("geometry_msgs", "PoseWithCovariance")
        self._sure_twist = self("geometry_msgs", "TwistWithCovariance")
        self._scan = self("sensor_msgs", "LaserScan")

    def __call__(self, package: str, name: str) -> Any:
        """The class of a message."""
        return self._types[f"{package}/msg/{name}"]

    def cdr(self, message: Any, kind: str) -> bytes:
        """A message of a type as CDR, little endian."""
        return bytes(self.store.serialize_cdr(message, kind))

    def from_cdr(self, content: bytes, kind: str) -> Any:
        """The message of a type; raises some exception if the content is not one."""
        return self.store.deserialize_cdr(content, kind)

    def time(self, stamp: int) -> Any:
        """A time."""
        return self._time(*divmod(stamp, 1_000_000_000))

    def header(self, stamp: int, frame: str) -> Any:
        """A header."""
        return self._header(self.time(stamp), frame)

    def pose(self, x: float, y: float, heading: float) -> Any:
        """A pose in the plane."""
        return self._pose(self.point(x, y, 0.0), self._turned(heading))

    def stamped_pose(self, stamp: int, frame: str, pose: Sequence[float]) -> Any:
        """A pose with a header."""
        return self("geometry_msgs", "PoseStamped")(self.header(stamp, frame), self.pose(*pose))

    def pose_array(self, stamp: int, frame: str, poses: Iterable[Sequence[float]]) -> Any:
        """Poses with a header."""
        return self("geometry_msgs", "PoseArray")(self.header(stamp, frame), [self.pose(*pose) for pose in poses])

    def path(self, stamp: int, frame: str, poses: Iterable[Sequence[float]]) -> Any:
        """A path."""
        placed = [self.stamped_pose(stamp, frame, pose) for pose in poses]
        return self("nav_msgs", "Path")(self.header(stamp, frame), placed)

    def twist(self, forward: float, leftward: float, rate: float) -> Any:
        """A velocity [m/s, m/s, rad/s] in the frame of the body."""
        return self._twist(self._vector(forward, leftward, 0.0), self._vector(0.0, 0.0, rate))

    def command(self, kind: str, stamp: int, frame: str, velocity: Sequence[float]) -> Any:
        """A velocity as ``Twist`` or ``TwistStamped``."""
        twist = self.twist(*velocity)
        if kind == "geometry_msgs/msg/Twist":
            return twist
        return self("geometry_msgs", "TwistStamped")(self.header(stamp, frame), twist)

    def transform(self, stamp: int, parent: str, child: str, pose: Sequence[float]) -> Any:
        """Where the origin of one frame is in another."""
        x, y, heading = pose
        moved = self._transform(self._vector(x, y, 0.0), self._turned(heading))
        return self._stamped_transform(self.header(stamp, parent), child, moved)

    def odometry(
        self,
        stamp: int,
        frame: str,
        child: str,
        pose: Sequence[float],
        velocity: Sequence[float],
        unsure_pose: Floats | None = None,
        unsure_twist: Floats | None = None,
    ) -> Any:
        """Odometry; the velocity [m/s, m/s, rad/s] is in the frame of the body, and covariances are (36,) or zero."""
        return self._odometry(
            self.header(stamp, frame),
            child,
            self._sure_pose(self.pose(*pose), self._covariance if unsure_pose is None else unsure_pose),
            self._sure_twist(self.twist(*velocity), self._covariance if unsure_twist is None else unsure_twist),
        )

    def scan(
        self,
        stamp: int,
        frame: str,
        angles: tuple[float, float, float],
        limits: tuple[float, float],
        scan_time: float,
        ranges: NDArray[np.float32],
        beam_time: float = 0.0,
    ) -> Any:
        """A scan; ranges of beams that hit nothing are infinite (REP 117).

        The stamp is the time of the last beam; the header has the time of the first one. ``beam_time`` [s] is between
        two beams.
        """
        first = max(0, stamp - round(beam_time * 1e9 * (len(ranges) - 1)))
        times = beam_time, scan_time
        return self._scan(self.header(first, frame), *angles, *times, *limits, ranges, self._no_intensities)

    def grid(self, stamp: int, frame: str, side: float, origin: tuple[float, float], levels: NDArray[np.int8]) -> Any:
        """An occupancy grid.

        Args:
            stamp: Time [ns].
            frame: Frame of the origin.
            side: Side of a cell [m].
            origin: Lower left corner [m].
            levels: (nx, ny) from 0 to 100, -1 for unknown.
        """
        columns, rows = levels.shape
        info = self("nav_msgs", "MapMetaData")(self.time(0), side, columns, rows, self.pose(*origin, 0.0))
        return self("nav_msgs", "OccupancyGrid")(self.header(stamp, frame), info, levels.T.astype(np.int8).ravel())

    def vector(self, x: float, y: float, z: float) -> Any:
        """A vector."""
        return self._vector(x, y, z)

    def points(self, rows: Floats) -> list[Any]:
        """Points of the plane from an (N, 2) array."""
        return [self.point(x, y, 0.0) for x, y in rows.tolist()]

    def _turned(self, heading: float) -> Any:
        return self.quaternion(0.0, 0.0, math.sin(heading / 2), math.cos(heading / 2))
