"""A bag with odometry and scans becomes a scenario: a map of what the scans saw, and a robot that drives as it did."""
