"""Topics of a bridge to ROS: names, types and quality of service, and which of them go out."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

from irsim.bridges.base import BridgeError
from irsim.components.bridges._ros import TOPIC_NAME
from irsim.simulation.scene import SceneDescription, SceneObject

__all__ = [
    "LATCHED",
    "SENSOR",
    "STATE",
    "TABLE",
    "TRANSFORMS",
    "Mode",
    "Qos",
    "Row",
    "Topic",
    "frame_of",
    "laser_frame",
    "nanoseconds",
    "numbered",
    "ros_names",
    "scene_topics",
    "sensor_frame",
]

_FITS = re.compile(r"[A-Za-z](_?[A-Za-z0-9])*")
_NOT_IN_NAMES = re.compile(r"[^A-Za-z0-9]+")


def nanoseconds(seconds: float) -> int:
    """A time [s] in whole nanoseconds."""
    return round(seconds * 1e9)


def ros_names(names: Iterable[str]) -> list[str]:
    """Names of objects as parts of topics: letters, digits and single underscores, each only once.

    ``robot 1`` becomes ``robot_1``, and a name that begins with a digit gets ``object_`` in front. A name that can be
    part of a topic stays as it is, whatever the others are.
    """
    given = list(names)
    fitting = {name for name in given if _FITS.fullmatch(name)}
    made: list[str] = []
    for name in given:
        if name in fitting:
            made.append(name)
            continue
        plain = _NOT_IN_NAMES.sub("_", name).strip("_")
        plain = plain if plain and not plain[0].isdigit() else f"object_{plain}".rstrip("_")
        number, unique = 1, plain
        while unique in made or unique in fitting:
            number += 1
            unique = f"{plain}_{number}"
        made.append(unique)
    return made


@dataclass(frozen=True)
class Qos:
    """How the messages of a topic are delivered.

    Attributes:
        reliable: Whether lost messages are sent again; a best-effort writer never matches a reliable reader.
        latched: Whether those who subscribe later get the last messages (``transient_local``).
        depth: Number of messages that are kept (``keep_last``).
    """

    reliable: bool = True
    latched: bool = False
    depth: int = 10


STATE = Qos()
SENSOR = Qos(reliable=False, depth=5)
LATCHED = Qos(latched=True, depth=1)
TRANSFORMS = Qos(depth=100)


Mode: TypeAlias = Literal["sim", "real"]
Direction: TypeAlias = Literal["out", "in", ""]


@dataclass(frozen=True)
class Row:
    """A row of the table.

    Attributes:
        name: Name of the topic; ``{robot}`` is the name of a robot, ``{n}`` is ``_1`` for its second lidar, and so on.
        kind: Type of its messages; with ``Twist`` a user may have ``TwistStamped`` instead.
        sim: Whether it goes out or comes in when irsim moves the robots.
        real: Whether it goes out or comes in when the robots are real.
        per: Whether there is one topic, one for each robot, one for each lidar, or one for each sensor of a name.
        qos: How it is delivered.
        sensor: Name of the sensor, for ``per``.
    """

    name: str
    kind: str
    sim: Direction
    real: Direction
    per: Literal["scene", "robot", "lidar", "sensor"] = "scene"
    qos: Qos = STATE
    sensor: str = ""


_STAMPED_POSE = "geometry_msgs/msg/PoseStamped"
_STAMPED_START = "geometry_msgs/msg/PoseWithCovarianceStamped"
_TWIST = "geometry_msgs/msg/Twist"
TABLE: Mapping[str, Row] = {
    "clock": Row("/clock", "rosgraph_msgs/msg/Clock", "out", ""),
    "tf": Row("/tf", "tf2_msgs/msg/TFMessage", "out", "out", qos=TRANSFORMS),
    "tf_static": Row("/tf_static", "tf2_msgs/msg/TFMessage", "out", "", qos=LATCHED),
    "map": Row("/map", "nav_msgs/msg/OccupancyGrid", "out", "out", qos=LATCHED),
    "markers": Row("/irsim/markers", "visualization_msgs/msg/MarkerArray", "out", "out", qos=LATCHED),
    "pedestrians": Row("/pedestrians", "geometry_msgs/msg/PoseArray", "out", "out"),
    "pedestrian_ids": Row("/pedestrians/ids", "std_msgs/msg/String", "out", "out", qos=LATCHED),
    "goal_pose": Row("/goal_pose", _STAMPED_POSE, "in", "in"),
    "initialpose": Row("/initialpose", _STAMPED_START, "in", "in"),
    "odom": Row("/{robot}/odom", "nav_msgs/msg/Odometry", "out", "in", "robot"),
    "pose": Row("/{robot}/pose", _STAMPED_POSE, "out", "out", "robot"),
    "reference_path": Row("/{robot}/reference_path", "nav_msgs/msg/Path", "out", "out", "robot", LATCHED),
    "robot_goal_pose": Row("/{robot}/goal_pose", _STAMPED_POSE, "in", "in", "robot"),
    "robot_initialpose": Row("/{robot}/initialpose", _STAMPED_START, "in", "in", "robot"),
    "cmd_vel": Row("/{robot}/cmd_vel", _TWIST, "in", "out", "robot"),
    "cmd_vel_preview": Row("/{robot}/cmd_vel_preview", _TWIST, "", "out", "robot"),
    "scan": Row("/{robot}/scan{n}", "sensor_msgs/msg/LaserScan", "out", "in", "lidar", SENSOR),
    "imu": Row("/{robot}/imu{n}", "sensor_msgs/msg/Imu", "out", "", "sensor", SENSOR, "imu"),
    "wheel_odom": Row("/{robot}/wheel_odom{n}", "nav_msgs/msg/Odometry", "out", "", "sensor", STATE, "odometry"),
    "gnss": Row("/{robot}/gnss{n}", "sensor_msgs/msg/NavSatFix", "out", "", "sensor", SENSOR, "gnss"),
    "sonar": Row("/{robot}/sonar{n}", "sensor_msgs/msg/Range", "out", "", "sensor", SENSOR, "sonar"),
    "ir_range": Row("/{robot}/ir_range{n}", "sensor_msgs/msg/Range", "out", "", "sensor", SENSOR, "ir_range"),
    "localization": Row("/{robot}/localization{n}", _STAMPED_START, "out", "", "sensor", STATE, "localization"),
}
"""Key of a topic in options -> its row."""


@dataclass(frozen=True)
class Topic:
    """A topic of a scene.

    Attributes:
        key: Its key in :data:`TABLE`.
        name: Its name.
        kind: Type of its messages, such as ``nav_msgs/msg/Odometry``.
        outgoing: Whether irsim publishes it; else irsim subscribes.
        qos: How it is delivered.
        robot: Name of the robot whose topic it is, None for one of the scene.
        lidar: Key of the lidar, None for other topics.
        gauge: Key of the readings of a sensor without beams, None for other topics.
    """

    key: str
    name: str
    kind: str
    outgoing: bool
    qos: Qos
    robot: str | None = None
    lidar: str | None = None
    gauge: str | None = None


def frame_of(name: str, mode: Mode) -> str:
    """Frame of an object; in real mode it is not ``<robot>/base_link``, which the robot itself publishes."""
    return f"{name}/base_link" if mode == "sim" else f"irsim/{name}/base_link"


def laser_frame(name: str, number: int) -> str:
    """Frame of a lidar."""
    return sensor_frame(name, "laser", number)


def sensor_frame(name: str, sensor: str, number: int) -> str:
    """Frame of a sensor of an object, which is the first one of its name with the number 0."""
    return f"{name}/{sensor}{numbered(number)}"


def scene_topics(
    scene: SceneDescription,
    robots: Sequence[SceneObject],
    mode: Mode,
    *,
    names: Mapping[str, str | None],
    qos: Mapping[str, Qos],
    stamped: bool = False,
) -> tuple[Topic, ...]:
    """The topics of a scene.

    Args:
        scene: The scene.
        robots: Robots with topics of their own.
        mode: Whether irsim moves the robots.
        names: Key -> another name for its topics, or None for no topic.
        qos: Key -> another quality of service.
        stamped: Whether commands are ``TwistStamped``.

    Raises:
        BridgeError: A name cannot be one of a topic, or two topics have the same one.
    """
    spelled = dict(zip(scene.names, ros_names(scene.names), strict=True))
    result: list[Topic] = []
    for key, row in TABLE.items():
        direction = row.sim if mode == "sim" else row.real
        pattern = names.get(key, row.name)
        if not direction or pattern is None:
            continue
        if pattern != row.name and not TOPIC_NAME.fullmatch(pattern):
            what = f"{pattern!r} cannot be the name of a topic"
            raise BridgeError("bridge-mismatch", what, f"topics: {{{key}: {row.name}}}")
        kind = f"{row.kind}Stamped" if stamped and row.kind == _TWIST else row.kind
        base = Topic(key, pattern, kind, direction == "out", qos.get(key, row.qos))
        if row.per == "scene":
            result.append(base)
        for robot in robots if row.per != "scene" else ():
            named = pattern.replace("{robot}", spelled[robot.name])
            if row.per == "robot":
                result.append(replace(base, name=named, robot=robot.name))
                continue
            for gauge in robot.gauges if row.per == "sensor" else ():
                if gauge.name == row.sensor:
                    gauge_name = named.replace("{n}", numbered(gauge.number))
                    result.append(replace(base, name=gauge_name, robot=robot.name, gauge=gauge.key))
            for lidar in robot.lidars if row.per == "lidar" else ():
                lidar_name = named.replace("{n}", numbered(lidar.number))
                result.append(replace(base, name=lidar_name, robot=robot.name, lidar=lidar.key))
    _check_unique(result)
    return tuple(result)


def pedestrians(scene: SceneDescription) -> list[SceneObject]:
    """The obstacles that can move, in the order in which ``/pedestrians`` has them."""
    return [agent for agent in scene.agents if agent.role == "obstacle" and agent.moves]


def numbered(number: int) -> str:
    """How the name of a topic or frame ends for the first, second, … sensor."""
    return f"_{number}" if number else ""


def _check_unique(topics: Sequence[Topic]) -> None:
    seen: dict[str, Topic] = {}
    for topic in topics:
        other = seen.setdefault(topic.name, topic)
        if other is not topic:
            owners = f"{other.key} of {other.robot or 'the scene'} and {topic.key} of {topic.robot or 'the scene'}"
            what = f"two topics are called {topic.name!r}: {owners}"
            raise BridgeError("bridge-mismatch", what, f"topics: {{{topic.key}: /{{robot}}{topic.name}}}")
