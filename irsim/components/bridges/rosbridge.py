"""``rosbridge``: a client of rosbridge_server, with JSON over one TCP port."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim.components.bridges._ros import RosOptions
from irsim.components.options import opened_by
from irsim.options.registry import BRIDGES
from irsim.options.units import Integer


class Rosbridge(RosOptions):
    """Reach a robot with ROS 1 or ROS 2 through its rosbridge_server, with the topics of `ros2`.

    One TCP port is enough, so this is the way to a robot behind Wi-Fi, and from computers without ROS.
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "rosbridge", "host": "192.168.1.20"}]}

    name: Literal["rosbridge"] = "rosbridge"
    host: Annotated[str, Field(pattern=r"^[A-Za-z0-9.:_\-]+$")] = "127.0.0.1"
    """Name or address of the server."""
    port: Annotated[Integer, Field(ge=1, le=65535)] = 9090
    """Port of the server."""
    ros: Literal[1, 2] = 2
    """Version of ROS behind the server."""


BRIDGES.register(Rosbridge)(opened_by("ros"))
