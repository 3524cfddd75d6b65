"""A bridge to CARLA: pedestrians, vehicles and lidars of a town."""
