"""What ``irsim bridge doctor`` says of bags; the bridge itself is in :mod:`irsim.bridges.ros`."""
