"""Checks a recorded run from its files alone, with NumPy and shapely, and without the engine that simulated it."""
