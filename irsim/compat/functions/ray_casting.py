"""Ray casting against shapely geometries, for scripts without an environment; the core casts the beams of lidars."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from irsim.common.arrays import Floats

__all__ = ["cast_ray_segments", "cast_rays"]

MIN_RANGE_M = 1e-9
"""Hits nearer than this do not count [m]."""


def cast_rays(
    lidar_geometry: Any, detected_objects: Sequence[Any], max_range: float
) -> tuple[Floats, NDArray[np.int64], Floats, Floats]:
    """Cast beams at objects.

    Args:
        lidar_geometry: MultiLineString of the beams, each from the sensor outwards.
        detected_objects: Objects with an attribute ``geometry``.
        max_range: Length of the beams, and the range of a beam that hits nothing [m].

    Returns:
        A tuple (ranges, hits, origin, directions): (N,) ranges [m]; (N,) index of the object that each beam hits, or
        -1; (2,) origin [m]; (N, 2) vectors from the origin to the ends of the beams, divided by ``max_range``.
    """
    beams = np.array([[line.coords[0], line.coords[-1]] for line in lidar_geometry.geoms], dtype=np.float64)
    origin = beams[0, 0, :2] if len(beams) else np.zeros(2)
    directions = (beams[:, 1, :2] - beams[:, 0, :2]) / max_range if len(beams) else np.zeros((0, 2))
    starts, ends, owners = [], [], []
    for index, thing in enumerate(detected_objects):
        geometry = thing.geometry
        if geometry is None or geometry.is_empty:
            continue
        lines = geometry if geometry.geom_type.endswith("LineString") else geometry.boundary
        for line in shapely.get_parts(lines):
            points = np.asarray(line.coords, dtype=np.float64)[:, :2]
            starts.append(points[:-1])
            ends.append(points[1:])
            owners.append(np.full(len(points) - 1, index))
    ranges: NDArray[np.float64] = np.full(len(directions), float(max_range))
    hits: NDArray[np.int64] = np.full(len(directions), -1, dtype=np.int64)
    if starts and len(directions):
        ranges, edges = cast_ray_segments(origin, directions, np.vstack(starts), np.vstack(ends), max_range)
        hits = np.where(edges >= 0, np.concatenate(owners)[edges], -1).astype(np.int64)
    return ranges, hits, origin, directions


def cast_ray_segments(
    origin: Floats, directions: Floats, seg_start: Floats, seg_end: Floats, max_range: float
) -> tuple[Floats, NDArray[np.int64]]:
    """Find the nearest segment that each beam from one point hits.

    Args:
        origin: (2,) start of all beams [m].
        directions: (N, 2) directions of the beams.
        seg_start: (S, 2) first ends of the segments [m].
        seg_end: (S, 2) second ends of the segments [m].
        max_range: Length of the beams [m].

    Returns:
        (N,) ranges, ``max_range`` for a beam that hits nothing; (N,) index of the segment hit, or -1. Of several
        equally near segments the first counts.
    """
    edge = seg_end - seg_start
    away = seg_start - np.asarray(origin)
    cross = directions[:, None, 0] * edge[None, :, 1] - directions[:, None, 1] * edge[None, :, 0]
    along = away[:, 0] * edge[:, 1] - away[:, 1] * edge[:, 0]
    beside = away[None, :, 0] * directions[:, None, 1] - away[None, :, 1] * directions[:, None, 0]
    parallel = cross == 0.0
    divisor = np.where(parallel, 1.0, cross)
    distance, share = along[None, :] / divisor, beside / divisor
    hit = ~parallel & (share >= 0) & (share <= 1)
    # a beam along a segment hits its nearer end
    size = np.maximum((directions**2).sum(axis=1), np.finfo(float).tiny)[:, None]
    ends = [(directions @ (point - np.asarray(origin)).T) / size for point in (seg_start, seg_end)]
    ends = [np.where(end > MIN_RANGE_M, end, np.inf) for end in ends]
    collinear = parallel & (beside == 0.0)
    distance = np.where(collinear, np.minimum(*ends), distance)
    hit |= collinear
    distance = np.where(hit & (distance > MIN_RANGE_M) & (distance <= max_range), distance, np.inf)
    nearest = distance.argmin(axis=1)
    ranges = distance[np.arange(len(directions)), nearest]
    has_hit = np.isfinite(ranges)
    return np.where(has_hit, ranges, float(max_range)), np.where(has_hit, nearest, -1).astype(np.int64)
