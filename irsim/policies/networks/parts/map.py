"""``map``: a picture of the static objects around the robot."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from irsim.common.arrays import Floats
from irsim.options.units import Bool, Integer, Meters
from irsim.policies.networks.errors import PolicyInputError
from irsim.policies.networks.features import PARTS
from irsim.policies.networks.frames import Frame, x_axis
from irsim.policies.networks.parts._options import PartOptions
from irsim.policies.networks.values import Channel, Value
from irsim.policies.observations import Map, Observations
from irsim.policies.policy import Needs

_MAX_SAMPLES = 32
"""Largest number of samples along the side of a cell of the picture."""
_SAMPLES_AT_ONCE = 2_000_000
"""Samples of the robots whose pictures are made together; it bounds the memory."""


class MapPart(PartOptions):
    """A square picture around the robot: 1 where a static object is, 0 where none is.

    Row i of `cells` x `cells` numbers goes along x of the frame, column j along y. A cell is 1 if any point in it is
    occupied; the points are so dense that they hit every cell of the world's map.
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "map", "cells": 16, "size": 4.0}]}

    name: Literal["map"] = "map"
    cells: Annotated[Integer, Field(ge=1, le=64)] = 16
    """Cells along a side."""
    size: Annotated[Meters, Field(gt=0)] = 4.0
    """Length of a side; the robot is in the middle."""
    frame: Frame = "own"
    """Frame of the picture."""
    outside_occupied: Bool = True
    """Whether everything outside the world counts as occupied."""

    def needs(self) -> Needs:
        """The map, with cells half as large as those of the picture."""
        return Needs(map=True, map_resolution=0.5 * self.size / self.cells)

    def channels(self) -> tuple[Channel, ...]:
        """One for each cell."""
        return tuple(Channel(f"cell_{i}_{j}", 0.0, 1.0) for i in range(self.cells) for j in range(self.cells))


@PARTS.register(MapPart)
def picture(observations: Observations, options: MapPart) -> Value:
    """Observe the static objects around the robot.

    Args:
        observations: Of B robots, with maps.
        options: The options of the part.

    Returns:
        (B, n * n) features.

    Raises:
        PolicyInputError: There are no maps.
    """
    if observations.maps is None:
        raise PolicyInputError("the network observes the map of the world", "observe what `needs` declares")
    axis = x_axis(options.frame, observations)
    result = np.zeros((len(observations), options.cells * options.cells))
    numbers: dict[int, list[int]] = {}  # rows of one world share their map
    for row, seen in enumerate(observations.maps):
        numbers.setdefault(id(seen), []).append(row)
    for every in numbers.values():
        seen = observations.maps[every[0]]
        at_once = max(_SAMPLES_AT_ONCE // (options.cells * _samples(seen, options)) ** 2, 1)
        for first in range(0, len(every), at_once):
            rows = every[first : first + at_once]
            result[rows] = _look(seen, observations.pose[rows, :2], axis[rows], options)
    return Value(result)


def _samples(seen: Map, options: MapPart) -> int:
    """Samples along the side of a cell of the picture."""
    cell = options.size / options.cells
    return min(math.ceil(math.sqrt(2) * cell / seen.resolution), _MAX_SAMPLES)  # distances of resolution / sqrt(2)


def _look(seen: Map, center: Floats, axis: Floats, options: MapPart) -> Floats:
    """(B, n * n) pictures around (B, 2) centers with the x axes (B, 2), on one map."""
    samples = _samples(seen, options)
    count = options.cells * samples
    offset = (np.arange(count) + 0.5) * (options.size / count) - options.size / 2
    x, y = offset[:, None], offset[None, :]
    c, s = axis[:, 0, None, None], axis[:, 1, None, None]
    world_x = center[:, 0, None, None] + (x * c - y * s)
    world_y = center[:, 1, None, None] + (x * s + y * c)
    taken = _occupied(seen, world_x, world_y, options.outside_occupied)
    cells = taken.reshape(len(center), options.cells, samples, options.cells, samples).any(axis=(2, 4))
    return cells.reshape(len(center), options.cells * options.cells).astype(np.float64)


def _occupied(seen: Map, x: Floats, y: Floats, outside: bool) -> NDArray[np.bool_]:
    columns, rows = seen.occupied.shape
    i, j = np.floor((x - seen.origin[0]) / seen.resolution), np.floor((y - seen.origin[1]) / seen.resolution)
    inside = (i >= 0) & (i < columns) & (j >= 0) & (j < rows)
    at = seen.occupied[np.where(inside, i, 0).astype(np.int64), np.where(inside, j, 0).astype(np.int64)]
    return np.where(inside, at, outside)
