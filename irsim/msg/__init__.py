"""Messages in the shape of ROS messages; ``env.get_msg()`` makes them, ``env.receive_msg(…)`` reads them."""

from irsim.msg.geometry import (
    Header,
    Message,
    Point,
    Pose,
    PoseWithCovariance,
    Quaternion,
    Twist,
    TwistWithCovariance,
    Vector3,
)
from irsim.msg.messages import ContactState, LaserScan, ObjectState, Odometry, WorldState

__all__ = [
    "ContactState",
    "Header",
    "LaserScan",
    "Message",
    "ObjectState",
    "Odometry",
    "Point",
    "Pose",
    "PoseWithCovariance",
    "Quaternion",
    "Twist",
    "TwistWithCovariance",
    "Vector3",
    "WorldState",
]
