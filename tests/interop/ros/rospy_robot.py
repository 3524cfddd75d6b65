"""A robot on ROS 1 in a process of its own, without a timeout for commands: `rospy_robot.py [scan]`.

It obeys the last command that it got and publishes its odometry 20 times per second. Its lidar, if it is asked for, has
three beams, the middle one of which hits nothing. Lines of output: `command X Z`, `place X Y YAW`.
"""

from __future__ import annotations

import math
import sys
import time

sys.path.append("/usr/lib/python3/dist-packages")
import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

PERIOD_S = 0.05


def say(topic: str, *values: float) -> None:
    sys.stdout.write(f"{topic} {' '.join(f'{value:.4f}' for value in values)}\n")
    sys.stdout.flush()


def obey(message: Twist) -> None:
    command[:] = [message.linear.x, message.angular.z]
    say("command", *command)


command, x, y, yaw = [0.0, 0.0], 0.0, 0.0, 0.0
rospy.init_node("robot", disable_signals=True)
odometry = rospy.Publisher("/robot_0/odom", Odometry, queue_size=1)
lidar = rospy.Publisher("/robot_0/scan", LaserScan, queue_size=1)
listening = rospy.Subscriber("/robot_0/cmd_vel", Twist, obey)
due = time.monotonic()
while True:
    speed, rate = command
    x, y, yaw = x + PERIOD_S * speed * math.cos(yaw), y + PERIOD_S * speed * math.sin(yaw), yaw + PERIOD_S * rate
    said = Odometry()
    said.header.stamp, said.header.frame_id, said.child_frame_id = rospy.Time.now(), "odom", "base_link"
    said.pose.pose.position.x, said.pose.pose.position.y = x, y
    said.pose.pose.orientation.z, said.pose.pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    said.twist.twist.linear.x, said.twist.twist.angular.z = speed, rate
    odometry.publish(said)
    say("place", x, y, yaw)
    if "scan" in sys.argv:
        scan = LaserScan(angle_min=-1.0, angle_max=1.0, angle_increment=1.0, range_min=0.1, range_max=5.0)
        scan.header.frame_id, scan.ranges = "laser", [1.5, math.inf, 2.5]
        lidar.publish(scan)
    due += PERIOD_S
    time.sleep(max(0.0, due - time.monotonic()))
