"""A start and a goal on a map, far apart and with room around them, so that a run can follow at once."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from irsim.bridges.maps.grid import Bools
from irsim.bridges.maps.occupancy import within
from irsim.bridges.maps.regions import masked_regions
from irsim.bridges.maps.source import Occupancy
from irsim.common.arrays import Floats

__all__ = ["Trip", "suggest_trip"]

_CLEARANCES = (0.5, 0.4, 0.3, 0.25, 0.2, 0.15, 0.1, 0.05)
"""Distances from obstacles that are tried [m], the widest first."""
_SHARE = 0.7
"""Share of the diagonal of all free cells that the places with that clearance must reach over."""
_MAX_REACH = 64
"""Cells over which clearances are measured."""
_HALF = 50.0
"""Occupancy up to which a cell counts as free."""


@dataclass(frozen=True)
class Trip:
    """A start and a goal between which a point keeps a distance from everything that is not free.

    Attributes:
        start, goal: x, y, heading [m, rad].
        clearance: That distance [m].
    """

    start: tuple[float, float, float]
    goal: tuple[float, float, float]
    clearance: float


def suggest_trip(found: Occupancy, values: Floats) -> Trip | None:
    """Two places far apart in a map, both connected with as much room as most of the map has; None if it has no room.

    Args:
        found: The map.
        values: (nx, ny) its occupancies, unknown cells filled in.
    """
    free = values <= _HALF
    side = found.grid.resolution
    if not free.any():
        return None
    needed = _SHARE * _diagonal(masked_regions(free)[0] == 0)
    for clearance in (*_CLEARANCES, side / 2):
        roomy = free & ~within(~free, min(clearance / side, _MAX_REACH) + 0.5)
        if roomy.any():
            places = masked_regions(roomy)[0] == 0
            if _diagonal(places) >= needed or clearance <= side:
                return _trip(found, places, clearance)
    return None


def _diagonal(places: Bools) -> float:
    """Diagonal of the rectangle around places [cells]."""
    i, j = np.nonzero(places)
    return math.hypot(float(i.max() - i.min()), float(j.max() - j.min()))


def _trip(found: Occupancy, places: Bools, clearance: float) -> Trip:
    columns = np.flatnonzero(places)
    points = found.grid.centers(columns)
    first = _farthest(points, points.mean(axis=0))
    second = _farthest(points, first)
    start, goal = sorted([first.tolist(), second.tolist()])
    heading = round(math.atan2(goal[1] - start[1], goal[0] - start[0]), 3)
    a, b = ((round(x, 3), round(y, 3), heading) for x, y in (start, goal))
    return Trip(a, b, clearance)


def _farthest(points: Floats, place: Floats) -> Floats:
    far: Floats = points[np.argmax(((points - place) ** 2).sum(axis=1))]
    return far
