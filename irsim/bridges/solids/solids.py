"""Parts of footprints as solids seen from above: boxes, disks and convex outlines, each to be extended upwards."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from irsim.bridges.solids.convex import convex_pieces, is_convex
from irsim.common.arrays import Floats
from irsim.common.outline import BodyPart, Circle, Line, Polygon
from irsim.simulation.scene import SceneDescription

__all__ = ["Box", "Solid", "part_points", "room_of", "solids_of"]

_RIGHT_ANGLE = 1e-9
"""Cosine below which two sides of a rectangle are at right angles."""


@dataclass(frozen=True)
class Box:
    """A rectangle.

    Attributes:
        center: x, y [m], body frame.
        half: Half of its length along its own x axis, and of its width [m].
        yaw: Direction of its own x axis in the body frame [rad].
    """

    center: tuple[float, float]
    half: tuple[float, float]
    yaw: float = 0.0


Solid: TypeAlias = Box | Circle | Polygon
"""A box, a disk or a convex polygon, body frame."""


def solids_of(part: BodyPart, thickness: float) -> list[Solid]:
    """The solids that together are a part of a footprint.

    Args:
        part: The part. A polygon that is not convex becomes several outlines that fill it; a closed line, the walls of
            a room, has its thickness outside.
        thickness: Thickness of lines, which have none in irsim [m].
    """
    if isinstance(part, Circle):
        return [part]
    if isinstance(part, Line):
        return _walls(part, thickness)
    if not is_convex(part.corners):
        return [_box_or_outline(piece) for piece in convex_pieces(part.corners)]
    return [_box_or_outline(part.corners)]


def _box_or_outline(corners: Floats) -> Solid:
    """A box if the corners are those of a rectangle."""
    sides = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(*sides.T)
    if len(corners) == 4 and (lengths > 0).all():
        unit = sides / lengths[:, None]
        if max(abs(float(unit[k] @ unit[(k + 1) % 4])) for k in range(4)) < _RIGHT_ANGLE:
            x, y = corners.mean(axis=0)
            yaw = float(np.arctan2(sides[0, 1], sides[0, 0]))
            return Box((float(x), float(y)), (float(lengths[0]) / 2, float(lengths[1]) / 2), yaw)
    return Polygon(corners)


def _walls(line: Line, thickness: float) -> list[Solid]:
    """One box for each segment of a line; those of a closed line, the walls of a room, stand outside of it."""
    points = line.path
    inward = 0.0
    if line.closed:
        x, y = points[:-1].T
        inward = float(np.sign(x @ np.roll(y, -1) - y @ np.roll(x, -1)))  # 1: the inside is on the left
    found: list[Solid] = []
    for a, b in itertools.pairwise(points):
        length = float(np.hypot(*(b - a)))
        if not length > 0:
            continue
        along = (b - a) / length
        left = np.array([-along[1], along[0]])
        x, y = (a + b) / 2 - left * inward * thickness / 2
        half = length / 2 + (thickness if inward else 0.0), thickness / 2
        found.append(Box((float(x), float(y)), half, float(np.arctan2(along[1], along[0]))))
    return found


def part_points(parts: tuple[BodyPart, ...]) -> Floats:
    """(K, 2) points whose convex hull encloses the parts of a footprint [m], body frame."""
    found: list[Floats] = [np.zeros((0, 2))]
    for part in parts:
        if isinstance(part, Circle):
            x, y = part.center
            r = part.radius
            found.append(np.array([[x - r, y - r], [x + r, y - r], [x + r, y + r], [x - r, y + r]]))
        else:
            found.append(part.corners if isinstance(part, Polygon) else part.points)
    return np.concatenate(found)


def room_of(scene: SceneDescription) -> Line | None:
    """The walls round a world, unless an object of the scene is these walls."""
    if not scene.walls or any(isinstance(part, Line) and part.closed for a in scene.agents for part in a.parts):
        return None
    (x0, y0), (x1, y1) = scene.low, scene.high
    return Line(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]), closed=True)
