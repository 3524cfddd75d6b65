"""The centres and discs of all objects of a world as arrays, which avoidance laws use."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from irsim.common.arrays import Floats
from irsim.common.outline import Circle, outline

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["AVOIDANCE_MARGIN", "centres", "discs"]

AVOIDANCE_MARGIN = 0.1
"""Margin [m] that the avoidance laws of IR-SIM add to the radius of a body."""


def centres(simulation: Simulation, world: int) -> Floats:
    """Return the centre of the area of every body of a world in its body frame, (N, 2) [m].

    The body frame of a map is the world frame. Centres are computed once per scene and set of bodies.
    """
    key = simulation.revision, *simulation.key(world)[:2]
    known: dict[int, tuple[tuple[int, int, int], Floats]] = simulation.__dict__.setdefault("_centres", {})
    if world not in known or known[world][0] != key:
        first = world * simulation.objects
        points = [_centre(simulation, first + i) for i in range(simulation.objects)]
        known[world] = key, np.array(points, dtype=np.float64).reshape(-1, 2)
    return known[world][1]


def discs(simulation: Simulation, world: int) -> Floats:
    """Return x, y [m], vx, vy [m/s] and padded radius [m] of every object of a world, (N, 5), in the world frame."""
    size = simulation.objects
    rows = slice(world * size, (world + 1) * size)
    pose, centre = simulation.pose[rows], centres(simulation, world)
    result = np.empty((size, 5))
    result[:, :2] = pose[:, :2]
    if centre.any():
        c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
        result[:, 0] += c * centre[:, 0] - s * centre[:, 1]
        result[:, 1] += s * centre[:, 0] + c * centre[:, 1]
    result[:, 2:4] = simulation.state.velocities_world(world)
    if simulation.drives is not None:
        objects = simulation.views(world)
        for index in simulation.drives.objects:
            result[index, 2:4] = objects[index].velocity_xy[:, 0]
    result[:, 4] = simulation.radius[rows] + AVOIDANCE_MARGIN
    return result


def _centre(simulation: Simulation, row: int) -> tuple[float, float]:
    body = outline(simulation.state, row)
    match body.parts:
        case (Circle(center),):
            return center
    point = body.shapely().centroid
    return point.x, point.y
