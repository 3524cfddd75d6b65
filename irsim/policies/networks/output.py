"""From the numbers of a network to controls or velocities."""

from __future__ import annotations

import numpy as np

from irsim.common.arrays import Floats
from irsim.policies.networks.document import OutputOptions
from irsim.policies.networks.errors import PolicyInputError
from irsim.policies.networks.frames import turn_back, x_axis
from irsim.policies.networks.values import Array, apply
from irsim.policies.observations import Observations

__all__ = ["decide"]


def decide(output: OutputOptions, numbers: Array, observations: Observations) -> Floats:
    """What the numbers of a network mean for B robots.

    Args:
        output: Their meaning.
        numbers: (B, F) result of the network.
        observations: What the robots observed.

    Returns:
        (B, 2) velocities in the world frame [m/s], or (B, C) controls.

    Raises:
        PolicyInputError: The network scales to the limits of controls, and a robot has none.
    """
    value = numbers.astype(np.float64)
    if output.choices is not None:
        value = np.array(output.choices, dtype=np.float64)[np.argmax(value, axis=1)]
    else:
        value = _scale(output, _squash(output, value), observations)
    if output.returns == "control":
        return value + observations.control[:, : value.shape[1]] if output.increment else value
    axis = x_axis(output.frame, observations)
    turned = turn_back(value, axis * np.array([1.0, -1.0]))  # turning forward is turning back by the opposite angle
    return turned + observations.velocity if output.increment else turned


def _squash(output: OutputOptions, value: Floats) -> Floats:
    if output.squash == "tanh":
        return apply("tanh", value)
    return np.clip(value, -1.0, 1.0) if output.squash == "clip" else value


def _scale(output: OutputOptions, value: Floats, observations: Observations) -> Floats:
    if output.limits:
        low, high = (limit[:, : value.shape[1]] for limit in (observations.low, observations.high))
        if not (np.isfinite(low).all() and np.isfinite(high).all()):
            message = "the network chooses between the limits of the controls, and a robot has infinite limits"
            raise PolicyInputError(message, "give the robot finite vel_min and vel_max")
    elif output.low is not None and output.high is not None:
        low, high = np.array([output.low], dtype=np.float64), np.array([output.high], dtype=np.float64)
    else:
        return value
    result: Floats = low + (value + 1.0) / 2.0 * (high - low)
    return result
