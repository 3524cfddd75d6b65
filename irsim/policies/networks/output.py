"""From the numbers of a network to controls or velocities."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irsim.common.arrays import Floats
from irsim.policies.networks.document import OutputOptions
from irsim.policies.networks.errors import PolicyInputError
from irsim.policies.networks.values import Array, apply, turn_back, x_axis
from irsim.policies.observations import Observations

__all__ = ["Present", "are_finite", "decide"]


@dataclass(frozen=True)
class Present:
    """Facts behind the meaning of numbers, for B robots, as in :class:`irsim.policies.Observations`.

    Attributes:
        pose, goal: (B, 3) x, y [m], heading [rad], world frame.
        velocity: (B, 2) [m/s], world frame.
        control, low, high: (B, 3) control executed last, and limits of the controls.
        bounded: Whether the limits are known to be finite.
    """

    pose: Floats
    goal: Floats
    velocity: Floats
    control: Floats
    low: Floats
    high: Floats
    bounded: bool = False

    @classmethod
    def of(cls, observations: Observations) -> Present:
        """That part of what robots observe."""
        o = observations
        return cls(o.pose, o.goal, o.velocity, o.control, o.low, o.high)


def decide(output: OutputOptions, numbers: Array, present: Present) -> Floats:
    """Decisions that the numbers of a network mean for B robots.

    Args:
        output: Their meaning.
        numbers: (B, F) result of the network.
        present: Where the robots are, and how they move.

    Returns:
        (B, 2) velocities in the world frame [m/s], or (B, C) controls.

    Raises:
        PolicyInputError: The network scales to the limits of controls, and a robot has infinite ones.
    """
    value = numbers.astype(np.float64)
    if output.choices is not None:
        value = np.array(output.choices, dtype=np.float64)[np.argmax(value, axis=1)]
    else:
        value = _scale(output, _squash(output, value), present)
    if output.returns == "control":
        return value + present.control[:, : value.shape[1]] if output.increment else value
    axis = x_axis(output.frame, present.pose, present.goal)
    turned = turn_back(value, axis * np.array([1.0, -1.0]))  # turning forward is turning back by the opposite angle
    return turned + present.velocity if output.increment else turned


def _squash(output: OutputOptions, value: Floats) -> Floats:
    if output.squash == "tanh":
        return apply("tanh", value)
    return np.minimum(np.maximum(value, -1.0), 1.0) if output.squash == "clip" else value


def _scale(output: OutputOptions, value: Floats, present: Present) -> Floats:
    if output.limits:
        low, high = present.low, present.high
        if not (present.bounded or are_finite(low, high, value.shape[1])):
            message = "the network chooses between the limits of the controls, and a robot has infinite limits"
            raise PolicyInputError(message, "give the robot finite vel_min and vel_max")
    elif output.low is not None and output.high is not None:
        low, high = np.array([output.low], dtype=np.float64), np.array([output.high], dtype=np.float64)
    else:
        return value
    share = (value + 1.0) / 2.0
    if low.shape[1] < share.shape[1]:
        return np.asarray(low + share * (high - low))
    result: Floats = np.empty_like(share)
    for k in range(share.shape[1]):  # whole columns are faster than short rows
        result[:, k] = low[:, k] + share[:, k] * (high[:, k] - low[:, k])
    return result


def are_finite(low: Floats, high: Floats, width: int) -> bool:
    """Whether the limits of the first controls of all robots are finite."""
    return bool(np.isfinite(low[:, :width]).all() and np.isfinite(high[:, :width]).all())
