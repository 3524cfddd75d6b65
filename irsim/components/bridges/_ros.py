"""Options that all bridges to ROS have in common."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal, TypeVar

from pydantic import Field, field_validator

from irsim.components.options import BridgeOptions
from irsim.diagnostics.diagnostic import suggestion
from irsim.options.base import Options, problem
from irsim.options.units import (
    Bool,
    Hertz,
    Integer,
    MetersPerSecond,
    MetersPerSecondSquared,
    RadiansPerSecond,
    Seconds,
    unit,
)

__all__ = ["TOPIC_KEYS", "TOPIC_NAME", "QosOptions", "RosOptions", "ShownOptions"]

TOPIC_KEYS = (
    "clock", "tf", "tf_static", "map", "markers", "pedestrians", "pedestrian_ids", "goal_pose", "initialpose", "odom",
    "pose", "reference_path", "robot_goal_pose", "robot_initialpose", "cmd_vel", "cmd_vel_preview", "scan",
    "imu", "wheel_odom", "gnss", "sonar", "ir_range", "localization",
)  # fmt: skip
"""Keys of the table of topics."""
TOPIC_NAME = re.compile(r"(/[A-Za-z_~{][A-Za-z0-9_{}]*)+")
"""Valid names of topics; ``{robot}`` and ``{n}`` are placeholders."""

T = TypeVar("T")
RadiansPerSecondSquared = Annotated[float, unit("rad/s^2")]
Delay = Annotated[Seconds, Field(gt=0, le=60)]


class QosOptions(Options):
    """Quality of service of a topic."""

    reliability: Literal["reliable", "best_effort"] = "reliable"
    """Whether lost messages are sent again. A best-effort writer is never heard by a reliable reader."""
    durability: Literal["volatile", "transient_local"] = "volatile"
    """Whether those who subscribe later get the last messages."""
    depth: Annotated[Integer, Field(ge=1, le=1000)] = 10
    """Number of messages that are kept for slow readers."""


class ShownOptions(BridgeOptions):
    """Choices of how a scene is shown."""

    objects: ClassVar[tuple[str, ...]] = ("robots",)
    robots_only: ClassVar[tuple[str, ...]] = ("robots",)

    clock: Literal["irsim", "external", "wall"] = "wall"
    """Who decides when a step is: `wall` steps in real time, `irsim` as fast as it can."""
    robots: list[str] = []
    """Names of the robots that have topics; empty for all robots."""
    topics: dict[str, str | None] = {}
    """Other names of topics, by their key in the table of topics: `{robot}` is the name of the robot, `{n}` is empty
    for its first sensor and `_1` for the second one, null omits a topic. Example: `{cmd_vel: /cmd_vel, tf: null}`."""
    qos: dict[str, QosOptions] = {}
    """Other qualities of service of topics, by their key in the table of topics."""
    frame: Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_/]*$")] = "map"
    """Name of the fixed frame, in which the coordinates of the scenario are."""

    @field_validator("topics", "qos")
    @classmethod
    def _check_topics(cls, value: dict[str, T]) -> dict[str, T]:
        for key, name in value.items():
            if key not in TOPIC_KEYS:
                fix = suggestion(key, TOPIC_KEYS, f"they are {', '.join(TOPIC_KEYS)}")
                raise problem("invalid-value", f"{key!r} is not a topic of the table", fix=fix)
            if isinstance(name, str) and not TOPIC_NAME.fullmatch(name):
                what = f"{name!r} cannot be the name of a topic: it begins with / and has letters, digits, _ and {{}}"
                raise problem("invalid-value", what, fix=f"topics: {{{key}: /{{robot}}/{key}}}")
        return value

    def model_post_init(self, context: Any) -> None:
        """Check what keys mean together."""
        if self.clock == "external":
            raise problem("invalid-value", "ROS does not decide when a step is", fix="clock: wall")


class RosOptions(ShownOptions):
    """A node of ROS that shows the scene and listens to commands and goals, or that drives real robots."""

    node: Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")] = "irsim_bridge"
    """Name of the node."""
    mode: Literal["sim", "real"] = "sim"
    """`sim`: irsim moves the robots and publishes what they would; `real`: the odometry of real robots moves them in
    the scene, their scans replace the simulated ones, and what their behaviors decide goes out as commands."""
    stamped: Bool = False
    """Whether commands are `TwistStamped` instead of `Twist`."""
    command_timeout: Delay = 0.5
    """Time after which a command counts no more. In `sim` mode the robot then stands still. In `real` mode it is the
    time after which a separate process sends zero commands if irsim hangs."""
    after_command: Literal["stop", "behavior"] = "stop"
    """When a simulated robot gets no more commands, it stops, or its behavior takes over again."""
    dry_run: Bool = True
    """In `real` mode: whether commands go to `<robot>/cmd_vel_preview` instead of `<robot>/cmd_vel`, so that nothing
    moves. Set it to false when all values look right."""
    max_speed: Annotated[MetersPerSecond, Field(gt=0, le=20)] = 0.5
    """Greatest speed that is commanded to a real robot."""
    max_turn: Annotated[RadiansPerSecond, Field(gt=0, le=20)] = 1.0
    """Greatest yaw rate that is commanded to a real robot."""
    max_acceleration: Annotated[MetersPerSecondSquared, Field(gt=0, le=100)] = 1.0
    """Greatest change of the commanded speed of a real robot; only a stop is immediate."""
    max_turn_acceleration: Annotated[RadiansPerSecondSquared, Field(gt=0, le=100)] = 3.0
    """Greatest change of the commanded yaw rate of a real robot; only a stop is immediate."""
    command_rate: Annotated[Hertz, Field(ge=2, le=200)] = 20.0
    """How often commands are sent to a real robot."""
    odom_timeout: Delay = 0.5
    """Age of the last odometry of a real robot above which it gets zero commands; the same for each of its lidars from
    their first scan on."""
    lost_timeout: Annotated[Seconds, Field(gt=0, le=3600)] = 10.0
    """Age of the last odometry of a real robot above which the run ends."""
    odom_origin: Literal["start", "world"] = "start"
    """Where the frame of the odometry of a real robot is: `start` puts the robot to its pose in the scenario when the
    first odometry comes; `world` takes the odometry as coordinates of the scenario."""
    timeout: Delay = 5.0
    """Time for which to wait for a connection, and for the first odometry of real robots."""

    def driven(self, robots: Sequence[str]) -> Sequence[str]:
        """The robots with topics."""
        return self.robots or robots

    def model_post_init(self, context: Any) -> None:
        """Check what keys mean together."""
        super().model_post_init(context)
        if self.mode == "real" and self.clock != "wall":
            raise problem("invalid-value", "real robots move in real time", fix="clock: wall")
        if self.lost_timeout < self.odom_timeout:
            raise problem("invalid-value", "lost_timeout is below odom_timeout",
                          fix=f"lost_timeout: {10 * self.odom_timeout:g}")  # fmt: skip
