"""The building blocks of messages: header, point, vector, quaternion, pose and twist, in the shape of ROS messages."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Header",
    "Message",
    "Point",
    "Pose",
    "PoseWithCovariance",
    "Quaternion",
    "Twist",
    "TwistWithCovariance",
    "Vector3",
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
    """Base class of all messages: conversion to plain data, and equality."""

    def to_dict(self) -> dict[str, Any]:
        """Convert the message to dictionaries, lists, numbers and strings."""
        plain: dict[str, Any] = _plain(self)
        return plain

    def __eq__(self, other: object) -> bool:
        """Compare type and content; a NaN equals nothing, as in NumPy."""
        if not isinstance(other, Message) or type(self) is not type(other):
            return NotImplemented
        return self.to_dict() == other.to_dict()

    __hash__ = None  # type: ignore[assignment]


@dataclass(eq=False)
class Header(Message):
    """Step number, simulated time [s] and frame."""

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
    """A vector; its unit is m/s, rad/s or N, depending on the field that holds it."""

    ros_type: ClassVar[str] = "geometry_msgs/Vector3"

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


@dataclass(eq=False)
class Quaternion(Message):
    """An orientation as a unit quaternion."""

    ros_type: ClassVar[str] = "geometry_msgs/Quaternion"

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    w: float = 1.0

    @classmethod
    def from_yaw(cls, yaw: float) -> Quaternion:
        """Return the rotation about the vertical axis by ``yaw`` [rad]."""
        return cls(0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2))

    def to_yaw(self) -> float:
        """Return the heading [rad], in [-pi, pi]."""
        sine = 2 * (self.w * self.z + self.x * self.y)
        return math.atan2(sine, 1 - 2 * (self.y * self.y + self.z * self.z))


@dataclass(eq=False)
class Pose(Message):
    """Position and orientation."""

    ros_type: ClassVar[str] = "geometry_msgs/Pose"

    position: Point = field(default_factory=Point)
    orientation: Quaternion = field(default_factory=Quaternion)


@dataclass(eq=False)
class PoseWithCovariance(Message):
    """A pose; its covariance (36,) is zero, because the simulated state is exact."""

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
    """A twist; its covariance (36,) is zero, because the simulated state is exact."""

    ros_type: ClassVar[str] = "geometry_msgs/TwistWithCovariance"

    twist: Twist = field(default_factory=Twist)
    covariance: NDArray[np.float64] = field(default_factory=_no_covariance)
