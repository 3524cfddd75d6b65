"""MuJoCo: scenes as its models, and co-simulation in which irsim decides and MuJoCo moves."""
