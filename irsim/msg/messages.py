"""Messages shaped like those of ROS (geometry_msgs, nav_msgs, sensor_msgs), without needing ROS."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any, ClassVar

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


def _xyz(vector: Any) -> tuple[float, float, float]:
    return float(vector.x), float(vector.y), float(vector.z)


def _no_covariance() -> NDArray[np.float64]:
    return np.zeros(36)


class Message:
    """What all messages have in common."""

    def to_dict(self) -> dict[str, Any]:
        """The message as mappings, lists, numbers and text."""
        plain: dict[str, Any] = _plain(self)
        return plain

    def __eq__(self, other: object) -> bool:
        """Whether it is the same kind of message with the same content; NaN is like nothing."""
        if not isinstance(other, Message) or type(self) is not type(other):
            return NotImplemented
        return self.to_dict() == other.to_dict()

    __hash__ = None  # type: ignore[assignment]


@dataclass(eq=False)
class Header(Message):
    """Number of the step, simulated time [s] and frame."""

    ros_type: ClassVar[str] = "std_msgs/Header"

    seq: int = 0
    stamp: float = 0.0
    frame_id: str = "world"


@dataclass(eq=False)
class Point(Message):
    """A point [m]."""

    ros_type: ClassVar[str] = "geometry_msgs/Point"

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


@dataclass(eq=False)
class Vector3(Message):
    """A vector: m/s, rad/s or N."""

    ros_type: ClassVar[str] = "geometry_msgs/Vector3"

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


@dataclass(eq=False)
class Quaternion(Message):
    """An orientation."""

    ros_type: ClassVar[str] = "geometry_msgs/Quaternion"

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


@dataclass(eq=False)
class Pose(Message):
    """Position and orientation."""

    ros_type: ClassVar[str] = "geometry_msgs/Pose"

    position: Point = field(default_factory=Point)
    orientation: Quaternion = field(default_factory=Quaternion)


@dataclass(eq=False)
class PoseWithCovariance(Message):
    """A pose; its covariance (36,) is zero, the state is exact."""

    ros_type: ClassVar[str] = "geometry_msgs/PoseWithCovariance"

    pose: Pose = field(default_factory=Pose)
    covariance: NDArray[np.float64] = field(default_factory=_no_covariance)


@dataclass(eq=False)
class Twist(Message):
    """Linear [m/s] and angular [rad/s] velocity, body frame."""

    ros_type: ClassVar[str] = "geometry_msgs/Twist"

    linear: Vector3 = field(default_factory=Vector3)
    angular: Vector3 = field(default_factory=Vector3)


@dataclass(eq=False)
class TwistWithCovariance(Message):
    """A twist; its covariance (36,) is zero."""

    ros_type: ClassVar[str] = "geometry_msgs/TwistWithCovariance"

    twist: Twist = field(default_factory=Twist)
    covariance: NDArray[np.float64] = field(default_factory=_no_covariance)


@dataclass(eq=False)
class Odometry(Message):
    """Pose in the frame of the header, twist in the frame of the body."""

    ros_type: ClassVar[str] = "nav_msgs/Odometry"

    header: Header = field(default_factory=Header)
    child_frame_id: str = ""
    pose: PoseWithCovariance = field(default_factory=PoseWithCovariance)
    twist: TwistWithCovariance = field(default_factory=TwistWithCovariance)

    @classmethod
    def from_object(cls, obj: Any, *, stamp: float = 0.0, seq: int = 0, frame_id: str = "world") -> Odometry:
        """Where an object is now and how it moves."""
        from irsim.msg.reading import odometry_of

        return odometry_of(obj, Header(seq, stamp, frame_id))

    @classmethod
    def from_msg(cls, msg: Any) -> Odometry:
        """A copy of odometry, also of native ROS: pose, twist and what there is of the header.

        Raises:
            TypeError: No ``pose.pose`` or ``twist.twist``.
        """
        try:
            pose, twist = msg.pose.pose, msg.twist.twist
            at, turn = pose.position, pose.orientation
            linear, angular = twist.linear, twist.angular
            copied = Pose(Point(*_xyz(at)), Quaternion(*_xyz(turn), float(turn.w)))
            moving = Twist(Vector3(*_xyz(linear)), Vector3(*_xyz(angular)))
        except (AttributeError, TypeError) as error:
            raise TypeError(f"odometry has pose.pose and twist.twist, with numbers in them: {error}") from None
        head = getattr(msg, "header", None)
        stamp: Any = getattr(head, "stamp", 0.0)
        seconds = float(stamp.sec) + 1e-9 * float(stamp.nanosec) if hasattr(stamp, "sec") else float(stamp)
        header = Header(int(getattr(head, "seq", 0)), seconds, str(getattr(head, "frame_id", "world")))
        child = str(getattr(msg, "child_frame_id", ""))
        return cls(header, child, PoseWithCovariance(copied), TwistWithCovariance(moving))

    def to_state_velocity(self, obj: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(state_dim, 1) state and (vel_dim, 1) control that this means for an object; zeros without a drive.

        Raises:
            ValueError: Numbers that are not finite.
        """
        from irsim.msg.reading import numbers_of

        state, control = numbers_of(obj, self)
        wanted = np.zeros(obj.vel_dim) if control is None else np.array(control)
        return np.array(state)[:, None], wanted[:, None]


@dataclass(eq=False)
class LaserScan(Message):
    """A scan: angles [rad], times [s], ranges (N,) [m], float32."""

    ros_type: ClassVar[str] = "sensor_msgs/LaserScan"

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

    @classmethod
    def from_sensor(
        cls, sensor: Any, *, stamp: float = 0.0, seq: int = 0, frame_id: str | None = None, use_inf: bool = False
    ) -> LaserScan:
        """What a lidar measures now; the frame is by default the type of the sensor, ``use_inf`` as in ``get_msg``."""
        from irsim.msg.reading import scan_of

        return scan_of(sensor, Header(seq, stamp, sensor.sensor_type if frame_id is None else frame_id), use_inf)


@dataclass(eq=False)
class ContactState(Message):
    """A contact: the other object, point [m], unit normal away from it, depth [m], force [N]."""

    other_id: int = -1
    other: str = ""
    point: Point = field(default_factory=Point)
    normal: Vector3 = field(default_factory=Vector3)
    depth: float = 0.0
    force: float = 0.0


@dataclass(eq=False)
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

    @classmethod
    def from_object(
        cls, obj: Any, *, stamp: float = 0.0, seq: int = 0, frame_id: str = "world", use_inf: bool = False
    ) -> ObjectState:
        """Everything about an object now."""
        from irsim.msg.reading import state_of

        return state_of(obj, Header(seq, stamp, frame_id), use_inf)

    @property
    def sensors(self) -> list[LaserScan]:
        """The scans under another name."""
        return self.scans


@dataclass(eq=False)
class WorldState(Message):
    """All objects of an environment at one moment."""

    header: Header
    name: str
    status: str
    step_time: float
    objects: list[ObjectState] = field(default_factory=list)

    @classmethod
    def from_env(cls, env: Any, frame_id: str = "world", use_inf: bool = False) -> WorldState:
        """Everything in an environment now."""
        from irsim.msg.reading import world_of

        return world_of(env, frame_id, use_inf)

    @property
    def robots(self) -> list[ObjectState]:
        """The robots."""
        return [state for state in self.objects if state.role == "robot"]

    @property
    def obstacles(self) -> list[ObjectState]:
        """The obstacles."""
        return [state for state in self.objects if state.role == "obstacle"]
