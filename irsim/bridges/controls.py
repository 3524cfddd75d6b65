"""Commands of the world outside (speeds and a yaw rate) in the words of a drive."""

from __future__ import annotations

import math
from collections.abc import Sequence

from irsim.bridges.base import BridgeError
from irsim.simulation.scene import SceneObject

__all__ = ["native_control"]

_YAW_RATE = ("diff", "skid_steer", "diff_dynamic")
"""Drives whose controls are forward speed and yaw rate."""


def native_control(
    agent: SceneObject, command: Sequence[float], *, steering_rate: bool, steer: float, period: float
) -> list[float]:
    """The control that follows a command as well as the drive can.

    A car gets the steering angle with the curvature of the command: ``atan(wheelbase * yaw rate / speed)``, and
    keeps its steering angle while it stands. The wheel of a tricycle gets the velocity of the point where it stands.

    Args:
        agent: The robot.
        command: Forward and leftward speed [m/s], yaw rate [rad/s], body frame.
        steering_rate: Whether the second control of a car is the rate of its steering angle.
        steer: Present steering angle of a car [rad].
        period: Time until the next command [s].

    Raises:
        BridgeError: The drive comes from a plug-in.
    """
    forward, left, rate = (float(value) for value in command)
    if agent.drive in _YAW_RATE:
        return [forward, rate]
    if agent.drive == "omni":
        return [forward, left]
    if agent.drive == "omni_angular":
        return [forward, left, rate]
    if agent.drive in ("acker", "single_track"):
        base = 1.0 if agent.wheelbase is None else agent.wheelbase
        angle = steer if abs(forward) < 1e-6 else math.atan(base * rate / forward)
        return [forward, (angle - steer) / period if steering_rate else angle]
    if agent.drive == "tricycle":
        across = rate * (1.0 if agent.wheelbase is None else agent.wheelbase)
        speed = math.copysign(math.hypot(forward, across), -1.0 if forward < 0.0 else 1.0)
        angle = steer if abs(speed) < 1e-6 else math.asin(across / speed)
        return [speed, (angle - steer) / period if steering_rate else angle]
    what = f"'{agent.name}' with the drive {agent.drive!r} cannot follow speeds and a yaw rate"
    raise BridgeError("bridge-mismatch", what, "use a robot with a drive of irsim, such as diff")
