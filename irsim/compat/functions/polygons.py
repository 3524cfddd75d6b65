"""Random polygons: star-shaped, counter-clockwise.

The vertices follow each other around a centre, with random angular steps and random distances from the centre, as in
M. Ounsworth's well-known recipe for random polygons.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from irsim.common.arrays import Floats
from irsim.simulation.active_env import current_rng

__all__ = ["generate_polygon", "polygon_inequality", "random_generate_polygon"]


def generate_polygon(
    center: Sequence[float], avg_radius: float, irregularity: float, spikeyness: float, num_vertices: int
) -> Floats:
    """Generate a random polygon.

    Args:
        center: x, y of the centre [m].
        avg_radius: Mean distance of the vertices from the centre [m].
        irregularity: Spread of the angular steps, 0 to 1.
        spikeyness: Spread of the distances from the centre, 0 to 1.
        num_vertices: Number of vertices, at least 3.

    Returns:
        (num_vertices, 2) vertices, counter-clockwise.

    Raises:
        ValueError: A spread is not between 0 and 1.
    """
    for name, value in (("irregularity", irregularity), ("spikeyness", spikeyness)):
        if not 0 <= value <= 1:
            raise ValueError(f"{name} must be between 0 and 1, got {value}")
    rng = current_rng()
    mean = 2 * math.pi / num_vertices
    steps = [float(rng.uniform(mean * (1 - irregularity), mean * (1 + irregularity))) for _ in range(num_vertices)]
    scale = 2 * math.pi / sum(steps)
    angle = float(rng.uniform(0, 2 * math.pi))
    points = []
    for step in steps:
        radius = min(max(float(rng.normal(avg_radius, spikeyness * avg_radius)), 0.0), 2 * avg_radius)
        points.append([center[0] + radius * math.cos(angle), center[1] + radius * math.sin(angle)])
        angle += step * scale
    return np.array(points)


def random_generate_polygon(
    number: int = 1,
    center_range: Sequence[float] | None = None,
    avg_radius_range: Sequence[float] | None = None,
    irregularity_range: Sequence[float] | None = None,
    spikeyness_range: Sequence[float] | None = None,
    num_vertices_range: Sequence[int] | None = None,
    **_: Any,
) -> Floats | list[Floats]:
    """Generate random polygons with random parameters.

    Args:
        number: Number of polygons.
        center_range: [xmin, ymin, xmax, ymax] of the centres [m]; default: the origin.
        avg_radius_range: Range of the mean distance of the vertices [m]; default [0.1, 1].
        irregularity_range: Range of the spread of the angular steps; default [0, 1].
        spikeyness_range: Range of the spread of the distances; default [0, 1].
        num_vertices_range: Range of the number of vertices, upper end excluded; default [4, 10].

    Returns:
        The (M, 2) vertices of the polygon, or a list of them if ``number`` is not 1.
    """
    centers = [0.0] * 4 if center_range is None else list(center_range)
    radii = [0.1, 1.0] if avg_radius_range is None else list(avg_radius_range)
    irregularities = [0.0, 1.0] if irregularity_range is None else list(irregularity_range)
    spikes = [0.0, 1.0] if spikeyness_range is None else list(spikeyness_range)
    counts = [4, 10] if num_vertices_range is None else list(num_vertices_range)
    rng = current_rng()
    center = rng.uniform(centers[:2], centers[2:], (number, 2))
    radius = rng.uniform(*radii, number)
    irregularity = rng.uniform(*irregularities, number)
    spikeyness = rng.uniform(*spikes, number)
    count = rng.integers(*counts, number)
    made = [
        generate_polygon(
            center[i].tolist(), float(radius[i]), float(irregularity[i]), float(spikeyness[i]), int(count[i])
        )
        for i in range(number)
    ]
    return made[0] if number == 1 else made


def polygon_inequality(points: Floats, straight: float = 0.0) -> tuple[Floats, Floats] | None:
    """Write a convex polygon as ``G p <= h``.

    Args:
        points: (M, 2) vertices in either direction [m].
        straight: A corner that turns less than this counts as straight [m2].

    Returns:
        G: (M, 2) outward normals of the edges, not normalised. h: (M, 1). None if the polygon is not convex.
    """
    edges = np.roll(points, -1, axis=0) - points
    ahead = np.roll(edges, -1, axis=0)
    turns = edges[:, 0] * ahead[:, 1] - edges[:, 1] * ahead[:, 0]
    if (turns < -straight).any() and (turns > straight).any():
        return None
    if turns.sum() < 0:
        points = points[::-1]
        edges = np.roll(points, -1, axis=0) - points
    normals = np.column_stack([edges[:, 1], -edges[:, 0]])
    return normals, (normals * points).sum(axis=1, keepdims=True)
