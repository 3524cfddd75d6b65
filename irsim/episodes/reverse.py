"""Cars under ``follow`` that would have to back up to get to their goal, but have no reverse."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from irsim.scenario.resolve.resolved import ObjectRecord
from irsim.scenario.yaml.formatting import flow

__all__ = ["lacks_reverse", "needs_reverse", "reverse_fix", "reverse_message", "turning_radius"]

_MAX_STEERING = 1.4
"""Steering angle [rad] that ``follow`` does not exceed."""


def lacks_reverse(record: ObjectRecord) -> bool:
    """Whether an object is a car under ``follow`` that cannot drive backward."""
    drive: Any = record.kinematics
    on_route = getattr(record.active_behavior, "name", "") == "follow"
    steered = bool(getattr(drive, "steered", False)) and bool(record.wheelbase)
    return on_route and steered and bool(record.vel_min) and record.vel_min[0] >= 0 and not record.static


def turning_radius(record: ObjectRecord) -> float:
    """Radius of the smallest circle that a car under ``follow`` drives [m]."""
    drive: Any = record.kinematics
    steering = min(_MAX_STEERING, math.inf if drive.psi_max is None else drive.psi_max)
    if drive.mode == "steer":
        steering = min(steering, record.vel_max[1])
    return (record.wheelbase or 0.0) / math.tan(steering) if steering > 0 else math.inf


def needs_reverse(record: ObjectRecord, pose: Sequence[float], goal: Sequence[float]) -> bool:
    """Whether a car that :func:`lacks_reverse` stands still because its goal lies inside its turning circle.

    ``follow`` then lets a car back up first; without reverse it waits there for ever.

    Args:
        record: The car.
        pose: x, y [m] and heading [rad].
        goal: x, y [m].
    """
    radius = turning_radius(record)
    dx, dy = goal[0] - pose[0], goal[1] - pose[1]
    if math.hypot(dx, dy) < record.goal_threshold or not math.isfinite(radius):
        return False
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    ahead, aside = cos * dx + sin * dy, abs(cos * dy - sin * dx)
    return math.hypot(ahead, aside - radius) < radius - 0.5 * record.goal_threshold


def reverse_fix(record: ObjectRecord) -> str:
    """The limits with which a car can back up."""
    return f"vel_min: {flow([-record.vel_max[0], *record.vel_min[1:]])}"


def reverse_message(record: ObjectRecord, pose: Sequence[float], goal: Sequence[float]) -> str | None:
    """Message for a car that stands still because it would have to back up; None if that is not the case."""
    if not lacks_reverse(record) or not needs_reverse(record, pose, goal):
        return None
    return (
        f"it needs reverse: the goal lies inside its turning circle of radius {turning_radius(record):.2f} m "
        f"({reverse_fix(record)} lets it back up)"
    )
