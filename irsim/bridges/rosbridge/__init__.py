"""What ``irsim bridge doctor`` says of rosbridge; the bridge itself is in :mod:`irsim.bridges.ros`."""
