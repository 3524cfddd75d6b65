"""What ``irsim bridge doctor`` says of ROS 2; the bridge itself is in :mod:`irsim.bridges.ros`."""
