"""Input from ROS: the newest message of each topic, and its content as irsim has it."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.ros.messages import Messages
from irsim.bridges.ros.topics import Topic
from irsim.simulation.scene import Lidar

__all__ = [
    "MAX_BYTES",
    "Arrival",
    "Inbox",
    "MessageError",
    "Odometry",
    "Scan",
    "decode",
    "fitted_ranges",
    "read_goal",
    "read_odometry",
    "read_twist",
]

MAX_TOLD = 100
"""Number of sentences of another program that are kept until they are read."""
MAX_BYTES = 8_000_000
"""Longest message that is kept; a scan of 100,000 beams has less than 1 MB."""


@dataclass(frozen=True)
class Arrival:
    """The last message of a topic.

    Attributes:
        content: CDR, or a message whose fields are attributes.
        when: Time of arrival [s], of the clock ``time.monotonic``.
    """

    content: Any
    when: float


class Inbox:
    """Keeps the newest message of each topic; any thread may put messages in."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._newest: dict[Topic, Arrival] = {}
        self._told: list[str] = []
        self.received = 0
        self.overwritten = 0
        self.refused = 0

    def put(self, topic: Topic, content: Any) -> None:
        """Keep a message instead of an older one of the same topic."""
        arrival = Arrival(content, time.monotonic())
        with self._lock:
            self.received += 1
            if isinstance(content, bytes) and len(content) > MAX_BYTES:
                self.refused += 1
                return
            self.overwritten += topic in self._newest
            self._newest[topic] = arrival

    def take(self) -> dict[Topic, Arrival]:
        """All that has come since the last call."""
        with self._lock:
            result, self._newest = self._newest, {}
        return result

    def tell(self, sentence: str) -> None:
        """Keep what the other program says about itself."""
        with self._lock:
            if len(self._told) < MAX_TOLD:
                self._told.append(sentence)

    def told(self) -> list[str]:
        """Sentences of the other program about itself since the last call."""
        with self._lock:
            result, self._told = self._told, []
        return result


MAX_METERS = 1e7
"""Greatest distance from the origin that is believed."""
MAX_SPEED = 1e3
"""Greatest speed [m/s, rad/s] that is believed."""
MAX_BEAMS = 100_000
"""Most beams of a scan that is read."""


class MessageError(ValueError):
    """A message is not usable; the text says what is wrong with it."""


@dataclass(frozen=True)
class Odometry:
    """Where a robot is by its own account.

    Attributes:
        pose: x, y [m], yaw [rad], frame of the odometry.
        velocity: Forward and leftward speed [m/s], yaw rate [rad/s], body frame.
    """

    pose: tuple[float, float, float]
    velocity: tuple[float, float, float]


@dataclass(frozen=True)
class Scan:
    """A scan as a lidar sent it.

    Attributes:
        angle_min, increment: Direction of the first beam, and from a beam to the next one [rad].
        ranges: (K,) [m]; not finite for a beam that hit nothing.
        low, high: Shortest and longest range [m].
    """

    angle_min: float
    increment: float
    ranges: NDArray[np.float32]
    low: float
    high: float


def decode(messages: Messages, topic: Topic, content: Any) -> Any:
    """The message of a topic.

    Raises:
        MessageError: The content is not one.
    """
    if not isinstance(content, bytes):
        return content
    try:
        return messages.from_cdr(content, topic.kind)
    except Exception:  # rosbags raises errors of many kinds for bytes that are not a message
        raise MessageError(f"{len(content)} bytes are not a {topic.kind}") from None


def read_twist(message: Any) -> tuple[float, float, float]:
    """Forward and leftward speed [m/s] and yaw rate [rad/s] of a ``Twist`` or ``TwistStamped``.

    Raises:
        MessageError: A value is missing or no usable number.
    """
    twist = getattr(message, "twist", message)
    linear, angular = _field(twist, "linear"), _field(twist, "angular")
    values = (_field(linear, "x", "linear."), _field(linear, "y", "linear."), _field(angular, "z", "angular."))
    return _numbers(values, MAX_SPEED, "the velocity")


def read_goal(message: Any, frame: str) -> tuple[float, float, float]:
    """x, y [m], yaw [rad] of a ``PoseStamped`` or ``PoseWithCovarianceStamped`` in the fixed frame.

    Raises:
        MessageError: A value is missing or no usable number, or the pose is in another frame.
    """
    named = str(_field(_field(message, "header"), "frame_id")).lstrip("/")
    if named not in ("", frame):
        raise MessageError(f"the pose is in the frame {named!r}, not in the fixed frame {frame!r}")
    pose = _field(message, "pose")
    return _pose(getattr(pose, "pose", pose))


def read_odometry(message: Any) -> Odometry:
    """Pose and velocity of an ``Odometry``.

    Raises:
        MessageError: A value is missing or no usable number.
    """
    return Odometry(_pose(_field(_field(message, "pose"), "pose")), read_twist(_field(message, "twist")))


def read_scan(message: Any) -> Scan:
    """A ``LaserScan``; null values of JSON and NaN are beams that hit nothing.

    Raises:
        MessageError: A value is missing or no usable number, or there are too many beams.
    """
    ranges = _field(message, "ranges")
    if not isinstance(ranges, (np.ndarray, Sequence)) or isinstance(ranges, (str, bytes)):
        raise MessageError("the ranges are not a list")
    if not 0 < len(ranges) <= MAX_BEAMS:
        raise MessageError(f"a scan has 1 to {MAX_BEAMS} beams, got {len(ranges)}")
    try:
        values = np.array([math.inf if one is None else one for one in ranges] if not isinstance(
            ranges, np.ndarray) else ranges, dtype=np.float32)  # fmt: skip
    except (TypeError, ValueError):
        raise MessageError("some ranges are not numbers") from None
    if values.ndim != 1:
        raise MessageError("the ranges are not a list of numbers")
    names = ("angle_min", "angle_increment", "range_min", "range_max")
    first, step, low, high = (_number(_field(message, name), MAX_METERS, name) for name in names)
    if abs(step) * (len(values) - 1) > 4 * math.pi:
        raise MessageError("the beams turn more than twice around the sensor")
    return Scan(first, step, values, low, high)


def fitted_ranges(scan: Scan, lidar: Lidar) -> NDArray[np.float32]:
    """(beams,) ranges [m] of a lidar of the scenario from a scan with other beams, each from the nearest direction.

    A beam that the scan does not have, or that is out of the range of either, hit nothing.
    """
    result = np.full(lidar.beams, math.inf, dtype=np.float32)
    count = len(scan.ranges)
    if scan.increment == 0.0:
        places = np.zeros(lidar.beams) if count == 1 else np.full(lidar.beams, math.nan)
    else:
        turn = 2 * math.pi / abs(scan.increment)
        places = np.mod((lidar.angles - scan.angle_min) / scan.increment + 0.5, turn) - 0.5
    nearest = np.round(np.nan_to_num(places, nan=-1.0)).astype(np.int64)
    seen = (nearest >= 0) & (nearest < count)
    result[seen] = scan.ranges[nearest[seen]]
    low, high = max(lidar.range_min, scan.low), min(lidar.range_max, scan.high)
    result[~((result >= low) & (result <= high))] = math.inf
    return result


def _pose(pose: Any) -> tuple[float, float, float]:
    place, turn = _field(pose, "position"), _field(pose, "orientation")
    x, y, _ = _numbers((_field(place, "x"), _field(place, "y"), 0.0), MAX_METERS, "the position")
    quaternion = [_number(_field(turn, axis), 2.0, "the orientation") for axis in "xyzw"]
    size = math.sqrt(sum(value * value for value in quaternion))
    if size == 0.0:  # what many programs send if they do not care about a heading
        return x, y, 0.0
    if abs(size - 1.0) > 0.1:
        raise MessageError(f"the orientation is not a unit quaternion, its length is {size:.3g}")
    qx, qy, qz, qw = quaternion
    return x, y, math.atan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz))


def _field(message: Any, name: str, of: str = "") -> Any:
    try:
        return getattr(message, name)
    except AttributeError:
        raise MessageError(f"the field {of}{name} is missing") from None


def _numbers(values: Sequence[Any], limit: float, what: str) -> tuple[float, float, float]:
    first, second, third = (_number(value, limit, what) for value in values)
    return first, second, third


def _number(value: Any, limit: float, what: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float, np.floating)):
        raise MessageError(f"{what} is not a number")
    number = float(value)
    if not math.isfinite(number):
        raise MessageError(f"{what} is {number}")
    if abs(number) > limit:
        raise MessageError(f"{what} is {number:.3g}, greater than {limit:g}")
    return number
