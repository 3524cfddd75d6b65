"""A node of ROS 1 in a process of its own: `rospy_peer.py SECONDS [numbered]`.

Its commands are all the same, or numbered in thousandths of the yaw rate; then every tenth is not a number.
"""

from __future__ import annotations

import itertools
import math
import sys
import time

sys.path.append("/usr/lib/python3/dist-packages")
import rospy
from geometry_msgs.msg import PoseStamped, Twist
from nav_msgs.msg import OccupancyGrid, Odometry
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray


def say(topic: str, text: object) -> None:
    sys.stdout.write(f"{topic} {text}\n")
    sys.stdout.flush()


rospy.init_node("peer", anonymous=True)
listening = [
    rospy.Subscriber("/robot_0/odom", Odometry, lambda m: say("odom", f"{m.pose.pose.position.x} {m.header.frame_id}")),
    rospy.Subscriber("/robot_0/scan", LaserScan, lambda m: say("scan", f"{len(m.ranges)} {max(m.ranges)}")),
    rospy.Subscriber("/tf", TFMessage, lambda m: say("tf", m.transforms[0].child_frame_id)),
    rospy.Subscriber("/map", OccupancyGrid, lambda m: say("map", f"{m.info.width} {m.info.height}")),
    rospy.Subscriber("/irsim/markers", MarkerArray, lambda m: say("markers", len(m.markers))),
]
command = rospy.Publisher("/robot_0/cmd_vel", Twist, queue_size=1)
goal = rospy.Publisher("/goal_pose", PoseStamped, queue_size=1)
twist, target = Twist(), PoseStamped()
twist.linear.x, twist.angular.z = 0.4, 0.5
target.header.frame_id, target.pose.position.x, target.pose.orientation.w = "map", 3.0, 1.0
end = time.monotonic() + float(sys.argv[1])
for number in itertools.count(1):
    if time.monotonic() > end:
        break
    if "numbered" in sys.argv:
        twist.linear.x, twist.angular.z = 0.4 if number % 10 else math.nan, number / 1000
    command.publish(twist)
    goal.publish(target)
    time.sleep(0.05)
