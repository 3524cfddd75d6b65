"""ROS: one table of topics and messages for all ways to a robot: DDS, rclpy, Zenoh, rospy, rosbridge and bags."""
