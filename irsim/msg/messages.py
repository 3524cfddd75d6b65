"""Messages about objects, sensors and environments, in the shape of ROS (nav_msgs, sensor_msgs), without ROS."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from irsim.msg.geometry import (
    Header,
    Message,
    Point,
    Pose,
    PoseWithCovariance,
    Quaternion,
    Twist,
    TwistWithCovariance,
    Vector3,
)
from irsim.objects.extensions.drives import body_twist, wheels_slip

__all__ = ["ContactState", "LaserScan", "ObjectState", "Odometry", "WorldState", "state_and_control"]

_MIN_STEERING_SPEED_M_S = 1e-6
"""Below this speed [m/s] the yaw rate of a car says nothing about its steering angle."""
_SCAN_KEYS = ("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time", "range_min", "range_max")


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
        """Return the present pose and twist of an object."""
        x, y, theta = np.asarray(obj.state)[:3, 0].tolist()
        return cls(
            header=Header(seq, stamp, frame_id),
            child_frame_id=f"{obj.name}/base_link",
            pose=PoseWithCovariance(Pose(Point(x, y, float(obj.z)), Quaternion.from_yaw(theta))),
            twist=TwistWithCovariance(_body_twist(obj)),
        )

    @classmethod
    def from_msg(cls, msg: Any) -> Odometry:
        """Copy an odometry message, which may be a native ROS one: pose, twist and the header fields it has.

        Raises:
            TypeError: The message has no ``pose.pose`` or ``twist.twist``.
        """
        try:
            pose, twist = msg.pose.pose, msg.twist.twist
            turn = pose.orientation
            copied = Pose(Point(*_xyz(pose.position)), Quaternion(*_xyz(turn), float(turn.w)))
            moving = Twist(Vector3(*_xyz(twist.linear)), Vector3(*_xyz(twist.angular)))
        except (AttributeError, TypeError) as error:
            raise TypeError(f"odometry must have pose.pose and twist.twist with numbers in them: {error}") from None
        head = getattr(msg, "header", None)
        stamp: Any = getattr(head, "stamp", 0.0)
        seconds = float(stamp.sec) + 1e-9 * float(stamp.nanosec) if hasattr(stamp, "sec") else float(stamp)
        header = Header(int(getattr(head, "seq", 0)), seconds, str(getattr(head, "frame_id", "world")))
        child = str(getattr(msg, "child_frame_id", ""))
        return cls(header, child, PoseWithCovariance(copied), TwistWithCovariance(moving))

    def to_state_velocity(self, obj: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the (state_dim, 1) state and (vel_dim, 1) control of an object that moves as this message says.

        The control is zero for an object without a drive.

        Raises:
            ValueError: A number is not finite.
        """
        state, control = state_and_control(obj, self)
        wanted = np.zeros(obj.vel_dim) if control is None else np.array(control)
        return np.array(state)[:, None], wanted[:, None]


@dataclass(eq=False)
class LaserScan(Message):
    """A scan: angles [rad], times [s], ranges (N,) [m], float32; the stamp is the time of its first beam."""

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
        """Return the present scan of a lidar.

        Args:
            sensor: The lidar.
            stamp: Simulated time [s] of its last beam.
            seq: Step number in the header.
            frame_id: Frame in the header; by default the type of the sensor.
            use_inf: As in ``env.get_msg``.
        """
        return _scan(sensor, Header(seq, stamp, sensor.sensor_type if frame_id is None else frame_id), use_inf)


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
    """State of one object at one moment; ``goal`` is a column or None."""

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
        """Return the present state of an object; ``use_inf`` as in ``env.get_msg``."""
        lidars = [sensor for sensor in obj.sensors if hasattr(sensor, "get_scan") and hasattr(sensor, "hits")]
        scans = []
        for number, lidar in enumerate(lidars):
            laser_frame = f"{obj.name}/laser" + (f"_{number}" if number else "")
            scans.append(_scan(lidar, Header(seq, stamp, laser_frame), use_inf))
        goal, contact = obj.goal, getattr(obj, "contact", None)
        force = [0.0, 0.0] if contact is None else np.asarray(contact.force).reshape(-1).tolist()
        return cls(
            header=Header(seq, stamp, frame_id),
            id=obj.id,
            name=obj.name,
            role=obj.role,
            kinematics=obj.kinematics,
            shape=obj.shape,
            odom=Odometry.from_object(obj, stamp=stamp, seq=seq, frame_id=frame_id),
            scan=scans[0] if scans else None,
            goal=None if goal is None else goal.copy(),
            static=obj.static,
            arrive=obj.arrive,
            collision=obj.collision,
            collision_ids=[other.id for other in obj.collision_obj],
            scans=scans,
            contact_force=Vector3(*force),
            contact_time=0.0 if contact is None else float(contact.contact_time),
            air_time=0.0 if contact is None else float(contact.air_time),
            contacts=[] if contact is None else [_contact(report) for report in contact.reports],
        )

    @property
    def sensors(self) -> list[LaserScan]:
        """The scans, under the name that objects use."""
        return self.scans


@dataclass(eq=False)
class WorldState(Message):
    """State of all objects of an environment at one moment."""

    header: Header
    name: str
    status: str
    step_time: float
    objects: list[ObjectState] = field(default_factory=list)

    @classmethod
    def from_env(cls, env: Any, frame_id: str = "world", use_inf: bool = False) -> WorldState:
        """Return the present state of an environment; ``use_inf`` as in ``env.get_msg``."""
        seq, stamp = env._world.count, env._world.time
        states = [
            ObjectState.from_object(obj, stamp=stamp, seq=seq, frame_id=frame_id, use_inf=use_inf)
            for obj in env.objects
        ]
        return cls(Header(seq, stamp, frame_id), env._world.name, env.status, env.step_time, states)

    @property
    def robots(self) -> list[ObjectState]:
        """The robots."""
        return [state for state in self.objects if state.role == "robot"]

    @property
    def obstacles(self) -> list[ObjectState]:
        """The obstacles."""
        return [state for state in self.objects if state.role == "obstacle"]


def state_and_control(obj: Any, odometry: Any) -> tuple[list[float], list[float] | None]:
    """Return the state and control of an object that moves as an odometry message says.

    Args:
        obj: The object; what the message does not say is taken from its present state and velocity.
        odometry: The message, which may be a native ROS one.

    Returns:
        The state (state_dim values) and the control (vel_dim values, or None for an object without a drive).

    Raises:
        TypeError: The message is not odometry.
        ValueError: A number is not finite.
    """
    try:
        pose, twist = odometry.pose.pose, odometry.twist.twist
        turn = pose.orientation
        numbers = [float(v) for v in (pose.position.x, pose.position.y, turn.x, turn.y, turn.z, turn.w)]
        numbers += [float(v) for v in (twist.linear.x, twist.linear.y, twist.angular.z)]
    except (AttributeError, TypeError) as error:
        raise TypeError(f"odometry must have pose.pose and twist.twist with numbers in them: {error}") from None
    if not all(map(math.isfinite, numbers)):
        raise ValueError(f"odometry for {obj.name!r} must have finite numbers, got {numbers}")
    x, y, qx, qy, qz, qw, forward, lateral, rate = numbers
    state: list[float] = obj.state[:, 0].tolist()
    state[:3] = [x, y, Quaternion(qx, qy, qz, qw).to_yaw()]
    if obj.kinematics is None:
        return state, None
    control: list[float] = obj.velocity[:, 0].tolist()
    control[0] = forward
    if obj.record.kinematics.steered:
        if abs(forward) > _MIN_STEERING_SPEED_M_S:
            state[3] = math.atan(rate * (obj.wheelbase or 1.0) / forward)
        control[1] = state[3]
        if obj.kinematics == "tricycle":
            control[0] /= math.cos(state[3])
        elif obj.kinematics == "single_track":
            state[4:7] = [forward, rate, math.atan2(lateral + obj.record.kinematics.rear * rate, forward)]
    elif obj.record.kinematics.speeds == 2:
        control[1:] = [lateral, rate][: len(control) - 1]
    elif len(control) > 1:
        control[1] = rate
    if obj.kinematics == "diff_dynamic":
        drive = obj.record.kinematics
        state[3:5] = ((forward + side * drive.track / 2 * rate) / drive.wheel_radius for side in (-1, 1))
    return state, control


def _xyz(vector: Any) -> tuple[float, float, float]:
    return float(vector.x), float(vector.y), float(vector.z)


def _body_twist(obj: Any) -> Twist:
    """Return the body-frame twist that the present control of an object produces."""
    control = [*obj.velocity[:, 0].tolist(), 0.0, 0.0]
    forward, lateral, rate = 0.0, 0.0, 0.0
    if wheels_slip(obj):
        forward, lateral, rate = body_twist(obj)
    elif obj.kinematics is not None and obj.record.kinematics.speeds == 2:
        forward, lateral, rate = control[0], control[1], control[2] if obj.vel_dim > 2 else 0.0
    elif obj.kinematics == "tricycle":
        steer = float(obj.state[3, 0])
        forward, rate = control[0] * math.cos(steer), control[0] * math.sin(steer) / (obj.wheelbase or 1.0)
    elif obj.kinematics == "acker":
        forward = control[0]
        rate = forward * math.tan(float(obj.state[3, 0])) / (obj.wheelbase or 1.0)
    elif obj.kinematics is not None:
        forward, rate = control[0], control[1]
    return Twist(Vector3(forward, lateral, 0.0), Vector3(0.0, 0.0, rate))


def _scan(lidar: Any, header: Header, use_inf: bool) -> LaserScan:
    scan = lidar.get_scan()
    if lidar.options.is_timed and math.isfinite(lidar.stamp):
        header = replace(header, stamp=lidar.stamp)
    lag = scan["time_increment"] * (len(scan["ranges"]) - 1)
    header = replace(header, stamp=max(0.0, header.stamp - lag)) if lag else header
    ranges = np.array(scan["ranges"], dtype=np.float32)
    if use_inf:
        hit = lidar.hits >= 0
        ranges[~scan["valid"]] = np.inf
        ranges[hit & ~scan["valid"] & (scan["ranges"] <= lidar.range_min)] = -np.inf
    return LaserScan(
        header=header,
        **{key: float(scan[key]) for key in _SCAN_KEYS},
        ranges=ranges,
        intensities=np.zeros(0, dtype=np.float32),
    )


def _contact(report: Any) -> ContactState:
    point, normal = np.asarray(report.point).reshape(-1), np.asarray(report.normal).reshape(-1)
    return ContactState(
        other_id=report.other.id,
        other=report.other.name,
        point=Point(*point.tolist()),
        normal=Vector3(*normal.tolist()),
        depth=float(report.depth),
        force=float(report.force),
    )
