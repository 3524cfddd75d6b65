"""From longitudes and latitudes to meters on a plane, for maps of footprints."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from irsim.bridges.maps.source import Outlined, unusable
from irsim.common.arrays import Floats

__all__ = ["WALL", "are_degrees", "in_meters"]

WALL = 0.2
"""Thickness of walls that a file draws as lines [m]."""
_AXIS, _FLATTENING = 6_378_137.0, 1 / 298.257223563
"""The ellipsoid of WGS 84."""
_SQUARED = _FLATTENING * (2 - _FLATTENING)
_WIDEST = 100_000.0
"""Largest distance over which the projection is exact to a few parts in 100,000 [m]."""


@dataclass(frozen=True)
class _Plane:
    """A transverse Mercator projection about a point, to the third order of the distance.

    Attributes:
        longitude, latitude: The point, which becomes the origin [degrees].
    """

    longitude: float
    latitude: float

    def project(self, points: Floats) -> Floats:
        """(K, 2) meters east and north of the origin for (K, 2) longitudes and latitudes."""
        latitudes = np.radians(points[:, 1])
        east = np.radians(points[:, 0] - self.longitude)
        middle = (latitudes + np.radians(self.latitude)) / 2
        along = _AXIS * (1 - _SQUARED) / (1 - _SQUARED * np.sin(middle) ** 2) ** 1.5
        across = _AXIS / np.sqrt(1 - _SQUARED * np.sin(latitudes) ** 2)
        y = along * (latitudes - np.radians(self.latitude))
        y = y + across * np.sin(latitudes) * np.cos(latitudes) * east**2 / 2
        return np.column_stack([across * np.cos(latitudes) * east, y])


def are_degrees(regions: list[Any]) -> bool:
    """Whether all coordinates can be longitudes and latitudes."""
    points = np.abs(shapely.get_coordinates(regions))
    return bool(np.all(points[:, 0] <= 180) and np.all(points[:, 1] <= 90))


def in_meters(path: Path, things: list[Outlined]) -> tuple[list[Outlined], list[str]]:
    """Things whose regions are in degrees, in meters; and a note that says how.

    Raises:
        BridgeError: They are too far apart for a plane.
    """
    if not things:
        return [], []
    left, lower, right, upper = shapely.total_bounds([thing.region for thing in things])
    plane = _Plane(round(float(left + right) / 2, 7), round(float(lower + upper) / 2, 7))
    placed = [replace(thing, region=shapely.transform(thing.region, plane.project)) for thing in things]
    bounds = shapely.total_bounds([thing.region for thing in placed])
    size = max(bounds[2] - bounds[0], bounds[3] - bounds[1])
    if not size <= _WIDEST or right - left > 90:
        raise unusable(path, "its outlines are more than 100 km apart", "cut out the part that the map is for")
    where = f"longitude {plane.longitude:.7f}, latitude {plane.latitude:.7f}"
    return placed, [f"x points east and y north of {where}, by a transverse Mercator projection about this point"]
