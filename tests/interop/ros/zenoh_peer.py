"""A peer on zenoh-ros2-sdk, a speaker of rmw_zenoh by ROBOTIS: `zenoh_peer.py MESSAGES PORT DOMAIN SECONDS`."""

from __future__ import annotations

import sys
import time
from typing import Any

from zenoh_ros2_sdk.message_registry import get_registry
from zenoh_ros2_sdk.publisher import ROS2Publisher
from zenoh_ros2_sdk.qos import QosDurability, QosProfile
from zenoh_ros2_sdk.session import ZenohSession
from zenoh_ros2_sdk.subscriber import ROS2Subscriber

folder, port, domain, seconds = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4])
get_registry(folder)
where: dict[str, Any] = {"domain_id": domain, "router_ip": "127.0.0.1", "router_port": port}
ZenohSession.get_instance("127.0.0.1", port)
time.sleep(1)  # until the session has heard of other sessions' tokens; it asks for them once
latched = QosProfile(durability=QosDurability.TRANSIENT_LOCAL, history_depth=1)


def say(topic: str, text: object) -> None:
    sys.stdout.write(f"{topic} {text}\n")  # at once, since each topic has a thread of its own
    sys.stdout.flush()


subscribers = [
    ROS2Subscriber("/robot_0/pose", "geometry_msgs/msg/PoseStamped",
                   lambda m: say("pose", f"{m.pose.position.x} {m.pose.position.y}"), **where),
    ROS2Subscriber("/robot_0/scan", "sensor_msgs/msg/LaserScan", lambda m: say("scan", len(m.ranges)), **where),
    ROS2Subscriber("/map", "nav_msgs/msg/OccupancyGrid",
                   lambda m: say("map", f"{m.info.width} {m.info.height}"), qos=latched, **where),
]  # fmt: skip
publisher = ROS2Publisher("/robot_0/cmd_vel", "geometry_msgs/msg/Twist", **where)
store = publisher.session_mgr.store.types
vector = store["geometry_msgs/msg/Vector3"]
end = time.monotonic() + seconds
while time.monotonic() < end:
    publisher.publish(linear=vector(0.4, 0.0, 0.0), angular=vector(0.0, 0.0, 0.5))
    time.sleep(0.05)
