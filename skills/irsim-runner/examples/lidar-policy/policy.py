"""Turn towards the goal as far as the lidar shows free space; slow down when something is near ahead."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

CLEAR = 1.2  # m, least free distance in a direction that is taken
MARGIN = 0.35  # m, the robot's radius and a safety margin


def act(env: Any) -> list[float]:
    """Return [forward m/s, yaw rate rad/s] for the first robot, which has the drive diff."""
    robot = env.robot
    x, y, heading = robot.state[:3, 0]
    goal_x, goal_y = robot.goal[:2, 0]
    wanted = math.remainder(math.atan2(goal_y - y, goal_x - x) - heading, math.tau)
    scan = env.get_lidar_scan()
    ranges = np.asarray(scan["ranges"])
    angles = np.linspace(scan["angle_min"], scan["angle_max"], len(ranges))
    free = free_distances(ranges, angles)
    clear = free >= min(CLEAR, math.hypot(goal_x - x, goal_y - y))
    if not clear.any():
        return [0.0, 1.0]
    turn = angles[clear][np.argmin(np.abs(angles[clear] - wanted))]
    ahead = free[np.argmin(np.abs(angles))]
    return [float(np.clip(ahead - MARGIN, 0.0, 1.0) * max(math.cos(turn), 0.0)), float(2.0 * turn)]


def free_distances(ranges: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Return the free distance along each beam for a robot as wide as the margin on both sides."""
    half = np.arcsin(np.clip(MARGIN / np.maximum(ranges, MARGIN), 0, 1))
    near = np.abs(angles[:, None] - angles[None, :]) <= half[None, :]
    return np.where(near, ranges[None, :], np.inf).min(axis=1)
