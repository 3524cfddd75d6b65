"""Values in a network: arrays of one row per robot, sets with a mask, and the frames that they are expressed in."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.common.arrays import Floats

__all__ = ["Array", "Channel", "Frame", "Shape", "Value", "add_in_order", "apply", "sides", "turn_back", "x_axis"]

Array = NDArray[Any]
"""Array of float32 or float64."""


class Channel(NamedTuple):
    """One number of an observation.

    Attributes:
        name: Its name.
        low, high: Bounds.
    """

    name: str
    low: float
    high: float


class Shape(NamedTuple):
    """Shape of a value without its rows of robots.

    Attributes:
        features: Number of features.
        members: Number of members of a set; None for one vector.
    """

    features: int
    members: int | None = None

    def __str__(self) -> str:
        return f"{self.features}" if self.members is None else f"{self.members} x {self.features}"


@dataclass(frozen=True)
class Value:
    """A vector or a set for each of B robots.

    Attributes:
        array: (B, F) vectors, or (B, K, F) sets.
        mask: (B, K) which members of the sets are present; None for vectors. Absent members may hold any number.
    """

    array: Array
    mask: NDArray[np.bool_] | None = None

    @property
    def shape(self) -> Shape:
        """Its shape without the rows of robots."""
        return Shape(self.array.shape[-1], None if self.mask is None else self.array.shape[1])

    def rows(self, some: slice) -> Value:
        """The value of some of the robots."""
        return Value(self.array[some], None if self.mask is None else self.mask[some])

    def flags(self) -> NDArray[np.uint8] | None:
        """The mask as the core takes it."""
        return None if self.mask is None else np.ascontiguousarray(self.mask).view(np.uint8)

    def flat(self) -> Array:
        """(B, F) or (B, K F) features of all members one after the other, with zeros for absent ones."""
        rows, *sides = self.array.shape
        return self.present().reshape(rows, math.prod(sides))

    def present(self) -> Array:
        """The array with zeros for absent members."""
        return self.array if self.mask is None else np.where(self.mask[:, :, None], self.array, 0)


def apply(name: str, array: Array) -> Array:
    """A function of the core, element by element.

    NumPy's own exponential and trigonometric functions have other last bits on other processors.
    """
    result: Array = core.elementwise(name, np.ascontiguousarray(array).reshape(-1)).reshape(array.shape)
    return result


def add_in_order(arrays: Iterable[Array]) -> Array:
    """The sum of arrays of equal shape, added one after the other; ``np.sum`` has an order for each shape."""
    first, *others = arrays
    total = first.copy()
    for array in others:
        total += array
    return total


def sides(shape: Sequence[int | None]) -> str:
    """A shape as text."""
    return " x ".join("any" if side is None else str(side) for side in shape) or "one number"


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
