"""What ``irsim bridge doctor`` says of ROS 1."""

from __future__ import annotations

from irsim.bridges.doctor import Part
from irsim.bridges.ros.backends.rospy_node import find_rospy

__all__ = ["PARTS"]

find_rospy()
PARTS = (
    Part("rospy", None, "source the setup.bash of ROS 1, or on Debian 12: apt install ros-base python3-rospy"),
    Part("rosbags", "rosbags", "bag"),
)
"""The libraries of the bridge."""
