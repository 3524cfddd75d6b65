"""From the points of a lidar of CARLA to the scan of a planar lidar."""

from __future__ import annotations

import math

import numpy as np

from irsim.common.angles import FULL_TURN, wrap
from irsim.common.arrays import Floats
from irsim.simulation.scene import Lidar

__all__ = ["scan_of_points", "usual_points"]

_STEEP = 10.0
"""Two neighbouring points are of one surface if the gap between them is at most this many times the one that a surface
across the beam has; that is a surface which the beam meets at 6° or more."""


def usual_points(lidar: Lidar) -> int:
    """Points in a full turn for a scan: four for each beam, from 720 to 20,000."""
    opening = abs(lidar.angle_max - lidar.angle_min)
    beams = FULL_TURN / opening * (lidar.beams - 1) if lidar.beams > 1 and opening > 0 else 90.0
    return min(20_000, max(720, math.ceil(4 * beams)))


def scan_of_points(points: Floats, lidar: Lidar, count: int, low: float, high: float) -> Floats:
    """Ranges of the beams of a planar lidar.

    Points outside of the band are left out. Of points above each other the nearest counts. A beam between two points of
    one surface has the range of the straight line through them; one at an edge has the range of the nearer direction.

    Args:
        points: (n, 3 or more) x forward, y to the **right**, z up [m], frame of the sensor.
        lidar: The lidar whose scan is wanted.
        count: Number of points of each channel in a full turn.
        low: Lower end of the band [m], relative to the sensor.
        high: Its upper end [m].

    Returns:
        (beams,) [m], infinite for a beam without a point, or whose point is beyond the longest range.
    """
    points = np.asarray(points, dtype=np.float64)
    kept = points[(points[:, 2] >= low) & (points[:, 2] <= high) & np.isfinite(points).all(axis=1)]
    beams = lidar.angles
    if not len(kept):
        return np.full(len(beams), np.inf)
    step = FULL_TURN / count
    angles, ranges = _nearest_in_columns(np.arctan2(-kept[:, 1], kept[:, 0]), np.hypot(kept[:, 0], kept[:, 1]), step)
    after = np.searchsorted(angles, wrap(beams)) % len(angles)
    before = after - 1
    ahead, behind = _turn(angles[after] - beams), _turn(beams - angles[before])
    near, far = ranges[before], ranges[after]
    gap = np.hypot(far * np.cos(ahead + behind) - near, far * np.sin(ahead + behind))
    reach = step * 1.5
    joined = (ahead <= reach) & (behind <= reach) & (gap <= _STEEP * step * np.maximum(near, far))
    with np.errstate(divide="ignore", invalid="ignore"):
        line = near * far * np.sin(ahead + behind) / (near * np.sin(behind) + far * np.sin(ahead))
    closest = np.where(ahead < behind, far, near)
    alone = np.where(np.minimum(ahead, behind) <= step / 2 * 1.01, closest, np.inf)
    found = np.where(joined & (ahead + behind > 1e-9), line, alone)
    return np.where(found <= lidar.range_max, found, np.inf)


def _turn(angle: Floats) -> Floats:
    """The angle in [0, 2 pi) [rad]; one that rounding made slightly negative is 0."""
    found: Floats = wrap(angle, 0.0)
    return np.where(found > FULL_TURN - 1e-9, 0.0, found)


def _nearest_in_columns(angles: Floats, ranges: Floats, step: float) -> tuple[Floats, Floats]:
    """Directions, sorted, and ranges of the nearest point of each direction; channels share their directions."""
    columns = np.round(_turn(angles - angles[0]) / step).astype(np.int64) % round(FULL_TURN / step)
    order = np.lexsort((ranges, columns))
    first = np.unique(columns[order], return_index=True)[1]
    chosen = order[first]
    found = wrap(angles[chosen])
    sequence = np.argsort(found, kind="stable")
    return found[sequence], ranges[chosen][sequence]
