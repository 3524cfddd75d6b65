"""ROS 2 messages as CDR, and the MCAP file that they are written to."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats

__all__ = ["Bag", "Messages", "nanoseconds", "ros_names"]

_NOT_IN_NAMES = re.compile(r"[^A-Za-z0-9]+")
_LATCHED = """\
- history: 1
  depth: 1
  reliability: 1
  durability: 1
  deadline: {sec: 9223372036, nsec: 854775807}
  lifespan: {sec: 9223372036, nsec: 854775807}
  liveliness: 1
  liveliness_lease_duration: {sec: 9223372036, nsec: 854775807}
  avoid_ros_namespace_conventions: false
"""
"""Quality of service of topics whose last message new subscribers get, as rosbag2 stores it: keep the last one,
reliable, transient local."""


def nanoseconds(seconds: float) -> int:
    """Simulated time [s] in whole nanoseconds."""
    return round(seconds * 1e9)


def ros_names(names: Iterable[str]) -> list[str]:
    """Names of objects as parts of topics: letters, digits and single underscores, each only once.

    ``robot 1`` becomes ``robot_1``, and a name that begins with a digit gets ``object_`` in front.
    """
    made: list[str] = []
    for name in names:
        plain = _NOT_IN_NAMES.sub("_", name).strip("_")
        plain = plain if plain and not plain[0].isdigit() else f"object_{plain}".rstrip("_")
        number, unique = 1, plain
        while unique in made:
            number += 1
            unique = f"{plain}_{number}"
        made.append(unique)
    return made


class Messages:
    """Makes messages from numbers. Positions are in m, angles in rad, times in ns; the plane is z = 0."""

    def __init__(self) -> None:
        from rosbags.typesys import Stores, get_typestore

        self.store = get_typestore(Stores.ROS2_HUMBLE)
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

    def time(self, stamp: int) -> Any:
        """A time."""
        return self._time(*divmod(stamp, 1_000_000_000))

    def header(self, stamp: int, frame: str) -> Any:
        """A header."""
        return self._header(self.time(stamp), frame)

    def pose(self, x: float, y: float, heading: float) -> Any:
        """A pose in the plane."""
        return self._pose(self.point(x, y, 0.0), self._turned(heading))

    def transform(self, stamp: int, parent: str, child: str, pose: Sequence[float]) -> Any:
        """Where the origin of one frame is in another."""
        x, y, heading = pose
        moved = self._transform(self._vector(x, y, 0.0), self._turned(heading))
        return self._stamped_transform(self.header(stamp, parent), child, moved)

    def odometry(self, stamp: int, frame: str, child: str, pose: Sequence[float], velocity: Sequence[float]) -> Any:
        """Odometry; the velocity [m/s, m/s, rad/s] is in the frame of the body."""
        forward, leftward, rate = velocity
        twist = self._twist(self._vector(forward, leftward, 0.0), self._vector(0.0, 0.0, rate))
        return self._odometry(
            self.header(stamp, frame),
            child,
            self._sure_pose(self.pose(*pose), self._covariance),
            self._sure_twist(twist, self._covariance),
        )

    def scan(
        self,
        stamp: int,
        frame: str,
        angles: tuple[float, float, float],
        limits: tuple[float, float],
        scan_time: float,
        ranges: NDArray[np.float32],
    ) -> Any:
        """A scan; ranges of beams that hit nothing are infinite (REP 117)."""
        return self._scan(self.header(stamp, frame), *angles, 0.0, scan_time, *limits, ranges, self._no_intensities)

    def vector(self, x: float, y: float, z: float) -> Any:
        """A vector."""
        return self._vector(x, y, z)

    def points(self, rows: Floats) -> list[Any]:
        """Points of the plane from an (N, 2) array."""
        return [self.point(x, y, 0.0) for x, y in rows.tolist()]

    def _turned(self, heading: float) -> Any:
        return self.quaternion(0.0, 0.0, math.sin(heading / 2), math.cos(heading / 2))


class Bag:
    """An MCAP file with the profile ``ros2``, to which messages are added.

    Args:
        target: The file.
        messages: Makes the messages.
    """

    def __init__(self, target: Path, messages: Messages) -> None:
        from mcap.writer import Writer

        self._file = open(target, "wb")  # noqa: SIM115
        self._writer = Writer(self._file)
        self._writer.start(profile="ros2", library="irsim")
        self._store = messages.store
        self._schemas: dict[str, int] = {}
        self._counts: dict[int, int] = {}

    def __enter__(self) -> Bag:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if kind is None:
                self._writer.finish()
        finally:
            self._file.close()

    def topic(self, name: str, kind: str, *, latched: bool = False, **about: str) -> tuple[int, str]:
        """Add a topic.

        Args:
            name: Its name.
            kind: Type of its messages, such as ``sensor_msgs/msg/LaserScan``.
            latched: Whether new subscribers get its last message.
            **about: Further metadata of the channel.

        Returns:
            What :meth:`add` takes.
        """
        if kind not in self._schemas:
            definition, _ = self._store.generate_msgdef(kind, ros_version=2)
            self._schemas[kind] = self._writer.register_schema(kind, "ros2msg", definition.encode())
        metadata = {**about, **({"offered_qos_profiles": _LATCHED} if latched else {})}
        return self._writer.register_channel(name, "cdr", self._schemas[kind], metadata), kind

    def add(self, topic: tuple[int, str], stamp: int, message: Any) -> None:
        """Add a message at a simulated time [ns]."""
        channel, kind = topic
        sequence = self._counts[channel] = self._counts.get(channel, 0) + 1
        data = bytes(self._store.serialize_cdr(message, kind))
        self._writer.add_message(channel, stamp, data, stamp, sequence)

    def describe(self, facts: dict[str, str], files: dict[str, bytes]) -> None:
        """Add metadata named ``irsim``, and files as attachments."""
        self._writer.add_metadata("irsim", facts)
        for name, content in files.items():
            kind = "application/json" if name.endswith(".json") else "application/yaml"
            self._writer.add_attachment(0, 0, name, kind, content)
