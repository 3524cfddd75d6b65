"""Messages shaped like those of ROS (geometry_msgs, nav_msgs, sensor_msgs), without needing ROS."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "ContactState",
    "Header",
    "LaserScan",
    "Message",
    "ObjectState",
    "Odometry",
    "Point",
    "Pose",
    "PoseWithCovariance",
    "Quaternion",
    "Twist",
    "TwistWithCovariance",
    "Vector3",
    "WorldState",
]


def _plain(value: Any) -> Any:
    if is_dataclass(value) and not isinstance(value, type):
        return {entry.name: _plain(getattr(value, entry.name)) for entry in fields(value)}
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return value.item() if isinstance(value, np.generic) else value


def _no_covariance() -> NDArray[np.float64]:
    return np.zeros(36)


class Message:
    """What all messages have in common."""

    def to_dict(self) -> dict[str, Any]:
        """The message as mappings, lists, numbers and text."""
        plain: dict[str, Any] = _plain(self)
        return plain


@dataclass
class Header(Message):
    """Number of the step, simulated time [s] and frame."""

    seq: int = 0
    stamp: float = 0.0
    frame_id: str = "world"


@dataclass
class Point(Message):
    """A point [m]."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


@dataclass
class Vector3(Message):
    """A vector: m/s, rad/s or N."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


@dataclass
class Quaternion(Message):
    """An orientation."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    w: float = 1.0

    @classmethod
    def from_yaw(cls, yaw: float) -> Quaternion:
        """The turn about the vertical axis by ``yaw`` [rad]."""
        return cls(0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2))

    def to_yaw(self) -> float:
        """Heading [rad], in [-pi, pi]."""
        across = 2 * (self.w * self.z + self.x * self.y)
        return math.atan2(across, 1 - 2 * (self.y * self.y + self.z * self.z))


@dataclass
class Pose(Message):
    """Position and orientation."""

    position: Point = field(default_factory=Point)
    orientation: Quaternion = field(default_factory=Quaternion)


@dataclass
class PoseWithCovariance(Message):
    """A pose; its covariance (36,) is zero, the state is exact."""

    pose: Pose = field(default_factory=Pose)
    covariance: NDArray[np.float64] = field(default_factory=_no_covariance)


@dataclass
class Twist(Message):
    """Linear [m/s] and angular [rad/s] velocity, body frame."""

    linear: Vector3 = field(default_factory=Vector3)
    angular: Vector3 = field(default_factory=Vector3)


@dataclass
class TwistWithCovariance(Message):
    """A twist; its covariance (36,) is zero."""

    twist: Twist = field(default_factory=Twist)
    covariance: NDArray[np.float64] = field(default_factory=_no_covariance)


@dataclass
class Odometry(Message):
    """Pose in the frame of the header, twist in the frame of the body."""

    header: Header = field(default_factory=Header)
    child_frame_id: str = ""
    pose: PoseWithCovariance = field(default_factory=PoseWithCovariance)
    twist: TwistWithCovariance = field(default_factory=TwistWithCovariance)


@dataclass
class LaserScan(Message):
    """A scan: angles [rad], times [s], ranges (N,) [m], float32."""

    header: Header
    angle_min: float
    angle_max: float
    angle_increment: float
    time_increment: float
    scan_time: float
    range_min: float
    range_max: float
    ranges: NDArray[np.float32]
    intensities: NDArray[np.float32]


@dataclass
class ContactState(Message):
    """A contact: the other object, point [m], unit normal away from it, depth [m], force [N]."""

    other_id: int = -1
    other: str = ""
    point: Point = field(default_factory=Point)
    normal: Vector3 = field(default_factory=Vector3)
    depth: float = 0.0
    force: float = 0.0


@dataclass
class ObjectState(Message):
    """Everything about one object at one moment; ``goal`` is a column or None."""

    header: Header
    id: int
    name: str
    role: str
    kinematics: str | None
    shape: str
    odom: Odometry
    scan: LaserScan | None
    goal: NDArray[np.float64] | None
    static: bool
    arrive: bool
    collision: bool
    collision_ids: list[int] = field(default_factory=list)
    scans: list[LaserScan] = field(default_factory=list)
    contact_force: Vector3 = field(default_factory=Vector3)
    contact_time: float = 0.0
    air_time: float = 0.0
    contacts: list[ContactState] = field(default_factory=list)


@dataclass
class WorldState(Message):
    """All objects of an environment at one moment."""

    header: Header
    name: str
    status: str
    step_time: float
    objects: list[ObjectState] = field(default_factory=list)

    @property
    def robots(self) -> list[ObjectState]:
        """The robots."""
        return [state for state in self.objects if state.role == "robot"]

    @property
    def obstacles(self) -> list[ObjectState]:
        """The obstacles."""
        return [state for state in self.objects if state.role == "obstacle"]
