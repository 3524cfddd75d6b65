"""``ros2``: nodes of ROS 2, over DDS without a ROS installation, with rclpy where it is sourced, or over Zenoh."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim.components.bridges._ros import RosOptions
from irsim.components.options import opened_by
from irsim.options.registry import BRIDGES
from irsim.options.units import Bool, Integer


class Ros2(RosOptions):
    """Take part in ROS 2: RViz, Nav2 and robots see the scene, and send commands and goals; or drive real robots.

    Keys of its topics are clock, tf, tf_static, map, markers, pedestrians, pedestrian_ids, odom, pose, reference_path
    and scan, and imu, wheel_odom, gnss, sonar, ir_range and localization of robots with such sensors, which go out, and
    cmd_vel, goal_pose, initialpose, robot_goal_pose and robot_initialpose, which come in;
    with `mode: real` odom and scan come in, and cmd_vel or cmd_vel_preview goes out.
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "ros2"}, {"name": "ros2", "backend": "zenoh"}]}

    name: Literal["ros2"] = "ros2"
    backend: Literal["auto", "rclpy", "dds", "zenoh"] = "auto"
    """How to reach other nodes: `rclpy` is the ROS installation whose environment is sourced, with its middleware;
    `dds` speaks to nodes with Fast DDS or Cyclone DDS and needs no ROS; `zenoh` speaks to nodes with rmw_zenoh; `auto`
    is `rclpy` if it can be imported, else `dds`. Nodes with DDS and nodes with Zenoh do not see each other."""
    distro: Literal["humble", "jazzy"] = "humble"
    """Release of ROS 2 of the other nodes, `jazzy` also for later ones. Only `ros2 node list` depends on it."""
    domain: Annotated[Integer, Field(ge=0, le=101)] | None = None
    """Number of the domain; default: the variable `ROS_DOMAIN_ID`, else 0."""
    loopback: Bool = False
    """With `dds`: whether to speak to nodes on this computer only, as also with the variables of ROS 2
    `ROS_LOCALHOST_ONLY=1` and `ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST`."""
    address: Annotated[str, Field(pattern=r"^[^\s/]+:[0-9]{1,5}$")] = "127.0.0.1:7447"
    """With `zenoh`: where the router listens, `host:port`."""
    router: Bool = False
    """With `zenoh`: whether to be that router, so that `rmw_zenohd` need not run."""


BRIDGES.register(Ros2)(opened_by("ros"))
