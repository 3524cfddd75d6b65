"""An occupancy grid from scans at known poses: each cell counts beams that ended in it and beams that went through."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.base import BridgeError
from irsim.bridges.ros.incoming import Scan
from irsim.common.arrays import Floats

__all__ = ["BagMap", "map_of_scans"]

MAX_CELLS = 25_000_000
_MAX_SAMPLES = 2_000_000
"""Points of beams that are handled at once."""
_OCCUPIED, _FREE, _UNKNOWN = 100, 0, -1


@dataclass(frozen=True)
class BagMap:
    """A grid.

    Attributes:
        levels: (nx, ny) 100 where beams ended, 0 where they went through, -1 where none came.
        resolution: Side of a cell [m].
        origin: Lower left corner [m].
    """

    levels: NDArray[np.int8]
    resolution: float
    origin: tuple[float, float]


def map_of_scans(
    poses: Floats, scans: Sequence[Scan], path: Floats, resolution: float, radius: float, margin: float
) -> BagMap:
    """Count the beams of scans.

    A beam that hit nothing clears cells as far as its lidar sees. A cell is solid if at least half as many beams ended
    in it as went through, since beams also graze the edge of what is solid.

    Args:
        poses: (S, 3) poses of the lidar at the scans.
        scans: S scans.
        path: (T, 2) where the robot was: it was free there.
        resolution: Side of a cell [m].
        radius: Radius of the robot [m].
        margin: Border around the path without scans [m].

    Raises:
        BridgeError: The map would have too many cells.
    """
    ends = [_ends(pose, scan) for pose, scan in zip(poses, scans, strict=True)]
    corners = np.concatenate([path, *(points for points, _ in ends)])
    low = np.floor((corners.min(axis=0) - margin) / resolution) * resolution
    counts = np.ceil((corners.max(axis=0) + margin - low) / resolution).astype(np.int64)
    if counts.prod() > MAX_CELLS:
        what = f"the map would have {counts[0]} x {counts[1]} cells"
        raise BridgeError("bridge-file", what, f"a larger resolution, such as --resolution {4 * resolution:g}")
    hits, passes = np.zeros(counts, dtype=np.int64), np.zeros(counts, dtype=np.int64)
    for pose, (points, hit) in zip(poses, ends, strict=True):
        _count(hits, points[hit], low, resolution)
        for part in _through(pose[:2], points, resolution):
            _count(passes, part, low, resolution)
    levels = np.full(counts, _UNKNOWN, dtype=np.int8)
    levels[passes > 0] = _FREE
    levels[(hits > 0) & (2 * hits >= passes)] = _OCCUPIED
    _clear(levels, path, low, resolution, radius)
    return BagMap(levels, resolution, (float(low[0]), float(low[1])))


def _ends(pose: Floats, scan: Scan) -> tuple[Floats, NDArray[np.bool_]]:
    """(K, 2) ends of the usable beams, and (K,) whether they hit something."""
    ranges = scan.ranges.astype(np.float64)
    angles = pose[2] + scan.angle_min + scan.increment * np.arange(len(ranges))
    hit = (ranges >= scan.low) & (ranges <= scan.high)
    missed = np.isposinf(ranges) | (np.isfinite(ranges) & (ranges > scan.high))
    used = hit | missed
    lengths = np.where(hit, ranges, scan.high)[used]
    points = pose[:2] + lengths[:, None] * np.column_stack([np.cos(angles[used]), np.sin(angles[used])])
    return points, hit[used]


def _through(start: Floats, ends: Floats, resolution: float) -> list[Floats]:
    """Points along beams, closer together than cells, without the last cell of each."""
    lengths = np.hypot(*(ends - start).T)
    steps = np.maximum(0, np.floor(lengths / (0.7 * resolution)).astype(np.int64) - 1)
    parts = []
    size = max(1, _MAX_SAMPLES // max(1, int(steps.max(initial=1))))
    for first in range(0, len(ends), size):
        some, count = ends[first : first + size], steps[first : first + size]
        beam = np.repeat(np.arange(len(some)), count)
        place = np.arange(len(beam)) - np.repeat(np.cumsum(count) - count, count)
        share = place / np.maximum(1.0, lengths[first : first + size] / (0.7 * resolution))[beam]
        parts.append(start + share[:, None] * (some[beam] - start))
    return parts


def _count(counts: NDArray[np.int64], points: Floats, low: Floats, resolution: float) -> None:
    """Add one to each cell once, however many points of a scan it has."""
    cells = np.floor((points - low) / resolution).astype(np.int64)
    cells = cells[((cells >= 0) & (cells < counts.shape)).all(axis=1)]
    counts.reshape(-1)[np.unique(np.ravel_multi_index(tuple(cells.T), counts.shape))] += 1


def _clear(levels: NDArray[np.int8], path: Floats, low: Floats, resolution: float, radius: float) -> None:
    """Where the robot was, it was free."""
    reach = math.ceil(radius / resolution) + 1
    steps = np.arange(-reach, reach + 1)
    around = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    around = around[np.hypot(*around.T) * resolution <= radius + resolution]
    own = np.unique(np.floor((path - low) / resolution).astype(np.int64), axis=0)
    for shift in around:
        cells = own + shift
        cells = cells[((cells >= 0) & (cells < levels.shape)).all(axis=1)]
        levels[cells[:, 0], cells[:, 1]] = _FREE
