"""Frames that observations are expressed in."""

from __future__ import annotations

from typing import Literal

import numpy as np

from irsim.common.arrays import Floats
from irsim.policies.networks.values import apply

__all__ = ["Frame", "turn_back", "x_axis"]

Frame = Literal["own", "goal", "world"]
"""``own``: x points ahead; ``goal``: x points to the goal (ahead without one); ``world``: as in the scenario. The robot
is the origin of all."""


def x_axis(frame: Frame, pose: Floats, goal: Floats) -> Floats:
    """Unit vector of the x axis of a frame, in the world frame.

    Args:
        frame: The frame.
        pose: (B, 3) x, y [m] and heading [rad] of B robots, world frame.
        goal: (B, 3) the same of their goals; NaN without one.

    Returns:
        (B, 2) vectors.
    """
    if frame == "world":
        return np.broadcast_to(np.array([1.0, 0.0]), (len(pose), 2))
    ahead = np.stack([apply("cos", pose[:, 2]), apply("sin", pose[:, 2])], axis=-1)
    if frame == "own":
        return ahead
    there = np.isfinite(goal[:, 0]) & np.isfinite(goal[:, 1])
    offset = np.where(there[:, None], goal[:, :2] - pose[:, :2], 0.0)
    distance = np.sqrt(offset[:, 0] * offset[:, 0] + offset[:, 1] * offset[:, 1])  # np.hypot has other last bits
    far = distance > 0
    return np.where(far[:, None], offset / np.where(far, distance, 1.0)[:, None], ahead)


def turn_back(vectors: Floats, axis: Floats) -> Floats:
    """(..., 2) vectors of the world frame, expressed in frames with the x axes ``axis`` (..., 2)."""
    x, y, c, s = vectors[..., 0], vectors[..., 1], axis[..., 0], axis[..., 1]
    return np.stack([x * c + y * s, y * c - x * s], axis=-1)
