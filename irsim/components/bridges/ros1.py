"""``ros1``: a node of ROS 1 with rospy."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim.components.bridges._ros import RosOptions
from irsim.components.options import opened_by
from irsim.options.registry import BRIDGES


class Ros1(RosOptions):
    """Take part in ROS 1 (Noetic or Debian's) with the topics of `ros2`; roscore must run."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "ros1"}]}

    name: Literal["ros1"] = "ros1"
    master: Annotated[str, Field(pattern=r"^http://[^\s/]+:[0-9]{1,5}/?$")] | None = Field(
        default=None, examples=["http://192.168.1.20:11311"]
    )
    """Address of the master; default: the variable `ROS_MASTER_URI`."""


BRIDGES.register(Ros1)(opened_by("ros"))
