"""The behavior ``give_way`` for differential drives: straight to the goal, but stop while a person is close ahead."""

from __future__ import annotations

import math
from typing import Any

import irsim


@irsim.register_behavior("diff", "give_way")
def give_way(ego_object: Any, external_objects: list[Any], distance: float = 1.5, **_: Any) -> list[float]:
    """Return [forward m/s, yaw rate rad/s]; ``distance`` [m] is measured between surfaces."""
    x, y, heading = ego_object.state[:3, 0]
    goal_x, goal_y = ego_object.goal[:2, 0]
    turn = math.remainder(math.atan2(goal_y - y, goal_x - x) - heading, math.tau)
    for other in external_objects:
        if "pedestrian" not in other.tags:
            continue
        dx, dy = other.state[0, 0] - x, other.state[1, 0] - y
        gap = math.hypot(dx, dy) - other.radius - ego_object.radius
        ahead = math.cos(math.atan2(dy, dx) - heading) > 0
        if ahead and gap < distance:
            return [0.0, 0.0]
    top = float(ego_object.vel_max[0, 0])
    return [top * max(math.cos(turn), 0.0), 2.0 * turn]
