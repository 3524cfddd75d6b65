"""Limits of commands to real robots."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ["ZERO", "Limits", "Velocity", "limited"]

Velocity = tuple[float, float, float]
"""Forward and leftward speed [m/s], yaw rate [rad/s], body frame."""
ZERO: Velocity = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Limits:
    """What a real robot may be commanded.

    Attributes:
        speed: Greatest speed [m/s].
        turn: Greatest yaw rate [rad/s].
        acceleration: Greatest change of the speed [m/s^2].
        turn_acceleration: Greatest change of the yaw rate [rad/s^2].
    """

    speed: float
    turn: float
    acceleration: float
    turn_acceleration: float


def limited(target: Sequence[float], before: Velocity, limits: Limits, period: float) -> Velocity:
    """The command that comes nearest to a wanted one.

    A velocity that is too fast is made slower as a whole, so that its arc stays the same. A stop is immediate, and what
    is not finite is a stop.

    Args:
        target: Wanted velocity.
        before: Command before.
        limits: The limits.
        period: Time since the command before [s].
    """
    if len(target) != 3 or not all(math.isfinite(value) for value in target) or not any(target):
        return ZERO
    speed, turn = math.hypot(target[0], target[1]), abs(target[2])
    scale = min(1.0, limits.speed / speed if speed else 1.0, limits.turn / turn if turn else 1.0)
    forward, left, rate = (scale * value for value in target)
    step = math.hypot(forward - before[0], left - before[1])
    share = min(1.0, limits.acceleration * period / step) if step else 1.0
    change = max(-limits.turn_acceleration * period, min(limits.turn_acceleration * period, rate - before[2]))
    return (
        before[0] + share * (forward - before[0]),
        before[1] + share * (left - before[1]),
        before[2] + change,
    )
