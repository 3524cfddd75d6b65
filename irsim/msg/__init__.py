"""Messages shaped like those of ROS; ``env.get_msg()`` makes them, ``env.receive_msg(…)`` reads them."""

from irsim.msg.messages import (
    ContactState,
    Header,
    LaserScan,
    Message,
    ObjectState,
    Odometry,
    Point,
    Pose,
    PoseWithCovariance,
    Quaternion,
    Twist,
    TwistWithCovariance,
    Vector3,
    WorldState,
)

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
