"""``rosbag``: a recording of what the ROS bridges would publish."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim.components.bridges._ros import ShownOptions
from irsim.components.options import opened_by
from irsim.options.registry import BRIDGES


class Rosbag(ShownOptions):
    """Record the topics of `ros2` to a bag of rosbag2 while a scenario runs; it opens in `ros2 bag` and Foxglove.

    A recorded run becomes such a bag afterwards, too: `irsim export --to rosbag2`.
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "rosbag", "folder": "crossing_bag"}]}

    files: ClassVar[tuple[str, ...]] = ("folder",)

    name: Literal["rosbag"] = "rosbag"
    clock: Literal["irsim", "external", "wall"] = "irsim"
    """Who decides when a step is: `irsim` as fast as it can, `wall` in real time."""
    folder: Annotated[str, Field(pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.\-]*$", max_length=100)] = "bag"
    """Name of the new folder, in the current directory."""
    storage: Literal["sqlite3", "mcap"] = "mcap"
    """How messages are stored: `mcap` opens in Foxglove, `sqlite3` in all releases of ROS 2."""


BRIDGES.register(Rosbag)(opened_by("ros"))
