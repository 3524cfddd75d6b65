"""Latitude and longitude of points of the plane that touches the earth at an origin."""

from __future__ import annotations

import math
from collections.abc import Sequence

__all__ = ["geodetic"]

_AXIS_M = 6_378_137.0
_FLATTENING = 1 / 298.257223563
"""The ellipsoid of WGS 84 (NIMA TR8350.2)."""


def geodetic(east: float, north: float, origin: Sequence[float]) -> tuple[float, float, float]:
    """Latitude [deg], longitude [deg] and height above the ellipsoid [m] of a point of the tangent plane.

    Args:
        east: The point [m]; the plane touches the ellipsoid, or is parallel to it in a height, at the origin.
        north: The same.
        origin: Latitude [deg], longitude [deg], height [m].

    References:
        B. R. Bowring, Transformation from spatial to geographical coordinates, Survey Review 23 (1976).
    """
    squared = _FLATTENING * (2 - _FLATTENING)  # of the eccentricity
    latitude, longitude, height = math.radians(origin[0]), math.radians(origin[1]), origin[2]
    sin_lat, cos_lat = math.sin(latitude), math.cos(latitude)
    curvature = _AXIS_M / math.sqrt(1 - squared * sin_lat * sin_lat)
    # In the meridian plane of the origin: outwards from the axis of the earth, eastwards, along the axis.
    out = (curvature + height) * cos_lat - sin_lat * north
    along = (curvature * (1 - squared) + height) * sin_lat + cos_lat * north
    radius, polar = math.hypot(out, east), _AXIS_M * (1 - _FLATTENING)
    reduced = math.atan2(along * _AXIS_M, radius * polar)
    latitude = math.atan2(
        along + squared / (1 - squared) * polar * math.sin(reduced) ** 3,
        radius - squared * _AXIS_M * math.cos(reduced) ** 3,
    )
    sin_found, cos_found = math.sin(latitude), math.cos(latitude)
    own = _AXIS_M * math.sqrt(1 - squared * sin_found * sin_found)
    above = radius * cos_found + along * sin_found - own
    around = math.degrees(longitude + math.atan2(east, out))
    return math.degrees(latitude), (around + 180) % 360 - 180, above
