"""The classes behind ``robot.kf``, ``robot.gf`` and registered behaviors."""
