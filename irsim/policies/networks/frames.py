"""Frames that observations are expressed in."""

from __future__ import annotations

from typing import Literal

import numpy as np

from irsim.common.arrays import Floats
from irsim.policies.networks.values import apply
from irsim.policies.observations import Observations

__all__ = ["Frame", "direction", "goal_offset", "length", "turn_back", "x_axis"]

Frame = Literal["own", "goal", "world"]
"""``own``: x points ahead; ``goal``: x points to the goal (ahead without one); ``world``: as in the scenario. The robot
is the origin of all."""


def length(vectors: Floats) -> Floats:
    """(...,) lengths of (..., 2) vectors; unlike ``np.hypot``, the same bits on every system."""
    result: Floats = np.sqrt(vectors[..., 0] * vectors[..., 0] + vectors[..., 1] * vectors[..., 1])
    return result


def direction(angle: Floats) -> Floats:
    """(..., 2) cosine and sine of (...,) angles [rad]."""
    return np.stack([apply("cos", angle), apply("sin", angle)], axis=-1)


def goal_offset(observations: Observations) -> tuple[Floats, Floats]:
    """(B, 2) vector from each robot to its goal [m], world frame, zero without one, and (B,) whether it has one."""
    there = np.isfinite(observations.goal[:, 0]) & np.isfinite(observations.goal[:, 1])
    offset = np.where(there[:, None], observations.goal[:, :2], observations.pose[:, :2]) - observations.pose[:, :2]
    return offset, there.astype(np.float64)


def x_axis(frame: Frame, observations: Observations) -> Floats:
    """(B, 2) unit vector of the x axis of a frame, in the world frame."""
    if frame == "world":
        return np.broadcast_to(np.array([1.0, 0.0]), (len(observations), 2))
    ahead = direction(observations.pose[:, 2])
    if frame == "own":
        return ahead
    offset, _ = goal_offset(observations)
    distance = length(offset)
    far = distance > 0
    return np.where(far[:, None], offset / np.where(far, distance, 1.0)[:, None], ahead)


def turn_back(vectors: Floats, axis: Floats) -> Floats:
    """(..., 2) vectors of the world frame, expressed in frames with the x axes ``axis`` (..., 2)."""
    x, y, c, s = vectors[..., 0], vectors[..., 1], axis[..., 0], axis[..., 1]
    return np.stack([x * c + y * s, y * c - x * s], axis=-1)
