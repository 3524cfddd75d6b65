"""What ``irsim bridge doctor`` says of ROS 1; the bridge itself is in :mod:`irsim.bridges.ros`."""
