"""What ``irsim bridge doctor`` says of bags."""

from __future__ import annotations

import tempfile
from pathlib import Path

from irsim.bridges.doctor import Part
from irsim.bridges.ros.backends.bag import BagFolder
from irsim.bridges.ros.messages import Messages

__all__ = ["PARTS"]


def _written_and_read() -> str:
    from rosbags.rosbag2 import Reader

    messages = Messages()
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder) / "bag"
        with BagFolder(bag, messages, "mcap", "bag") as file:
            topic = file.topic("/cmd_vel", "geometry_msgs/msg/Twist")
            file.add(topic, 1, messages.twist(0.5, 0.0, 1.0))
        with Reader(bag) as reader:
            [(_, _, content)] = reader.messages()
        return f"a bag was written and read again ({len(content)} bytes of a message)"


PARTS = (Part("rosbags", "rosbags", "bag", _written_and_read),)
"""The libraries of the bridge."""
