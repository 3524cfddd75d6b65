"""ROS: one table of topics and one set of messages for all ways to a robot: DDS, rclpy, Zenoh, rospy, rosbridge, bags."""
