"""Bodies and maps as other programs have them: solids, boxes around footprints, and cells of maps as rectangles."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import shapely

from irsim.common.arrays import Floats
from irsim.common.outline import BodyPart, Circle, Line, Outline, Polygon, triangles_of
from irsim.simulation.scene import Grid, SceneDescription, SceneObject

__all__ = [
    "BoundingBox",
    "Box",
    "Solid",
    "box_of",
    "colored",
    "convex_pieces",
    "is_convex",
    "merged_cells",
    "numbers",
    "part_points",
    "room_of",
    "solids_of",
    "triangles",
]

_SMALLEST_AREA = 1e-10
"""Smaller triangles are left out [m²]: solvers of contacts fail with them."""
_STRAIGHT = 1e-9
"""Sine of the turn at a corner, below which it counts as straight."""


def is_convex(corners: Floats) -> bool:
    """Whether a counterclockwise polygon (K, 2) turns left, or goes straight on, at each corner."""
    before, after = corners - np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0) - corners
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    scale = np.hypot(*before.T) * np.hypot(*after.T)
    if not (cross >= -_STRAIGHT * scale).all():
        return False
    turned = np.arctan2(cross, (before * after).sum(axis=1)).sum()
    return bool(abs(turned - 2 * np.pi) < 1e-3)  # a star turns left at each corner, too, but more than once round


def triangles(corners: Floats) -> Floats:
    """(K, 3, 2) counterclockwise triangles that fill a simple polygon (N, 2), with its corners only."""
    region = shapely.Polygon(corners)
    result = triangles_of(region if region.is_valid else region.buffer(0))
    (ax, ay), (bx, by) = (result[:, 1] - result[:, 0]).T, (result[:, 2] - result[:, 0]).T
    large: Floats = result[(ax * by - ay * bx) / 2 > _SMALLEST_AREA]
    return large


def convex_pieces(corners: Floats) -> list[Floats]:
    """Convex counterclockwise polygons that fill a simple polygon and touch only at their edges (Hertel, Mehlhorn).

    Args:
        corners: (K, 2) of the polygon, convex or not.
    """
    parts = triangles(corners)
    points, index = np.unique(parts.reshape(-1, 2), axis=0, return_inverse=True)
    pieces: dict[int, list[int]] = dict(enumerate(index.reshape(-1, 3).tolist()))
    owner: dict[tuple[int, int], int] = {}
    for key, piece in pieces.items():
        owner.update(dict.fromkeys(_edges(piece), key))
    for a, b in list(owner):
        one, other = owner.get((a, b)), owner.get((b, a))
        if one is None or other is None or one == other:
            continue
        merged = _merged(pieces[one], pieces[other], a, b)
        if not is_convex(points[merged]):
            continue
        del owner[a, b], owner[b, a]
        owner.update(dict.fromkeys(_edges(merged), one))
        pieces[one] = merged
        del pieces[other]
    return [points[piece] for piece in pieces.values()]


def _edges(piece: list[int]) -> list[tuple[int, int]]:
    return list(zip(piece, [*piece[1:], piece[0]], strict=True))


def _merged(one: list[int], other: list[int], a: int, b: int) -> list[int]:
    """Corners of two pieces together, of which one has the edge from a to b and the other has it from b to a."""
    k, m = one.index(b), other.index(a)
    first = one[k:] + one[:k]  # from b to a
    second = other[m:] + other[:m]  # from a to b
    return first + second[1:-1]


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
        thickness: Thickness of lines, which are infinitely thin in irsim [m].
    """
    if isinstance(part, Circle):
        return [part]
    if isinstance(part, Line):
        return _walls(part, thickness)
    if not is_convex(part.corners):
        return [_box_or_outline(piece) for piece in convex_pieces(part.corners)]
    return [_box_or_outline(part.corners)]


def _box_or_outline(corners: Floats) -> Solid:
    """A box if the corners form a rectangle, else a polygon."""
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
    """One box for each segment of a line; the boxes of a closed line, the walls of a room, stand outside of it."""
    points = line.path
    inward = 0.0
    if line.closed:
        x, y = points[:-1].T
        inward = float(np.sign(x @ np.roll(y, -1) - y @ np.roll(x, -1)))  # 1: the inside is on the left
    result: list[Solid] = []
    for a, b in itertools.pairwise(points):
        length = float(np.hypot(*(b - a)))
        if not length > 0:
            continue
        along = (b - a) / length
        left = np.array([-along[1], along[0]])
        x, y = (a + b) / 2 - left * inward * thickness / 2
        half = length / 2 + (thickness if inward else 0.0), thickness / 2
        result.append(Box((float(x), float(y)), half, float(np.arctan2(along[1], along[0]))))
    return result


def part_points(parts: tuple[BodyPart, ...]) -> Floats:
    """(K, 2) points whose convex hull encloses the parts of a footprint [m], body frame."""
    result: list[Floats] = [np.zeros((0, 2))]
    for part in parts:
        if isinstance(part, Circle):
            x, y = part.center
            r = part.radius
            result.append(np.array([[x - r, y - r], [x + r, y - r], [x + r, y + r], [x - r, y + r]]))
        else:
            result.append(part.corners if isinstance(part, Polygon) else part.points)
    return np.concatenate(result)


def room_of(scene: SceneDescription) -> Line | None:
    """The walls round a world, unless an object of the scene is these walls."""
    if not scene.walls or any(isinstance(part, Line) and part.closed for a in scene.agents for part in a.parts):
        return None
    (x0, y0), (x1, y1) = scene.low, scene.high
    return Line(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]), closed=True)


def merged_cells(grid: Grid) -> Floats:
    """(K, 4) rectangles x0, y0, x1, y1 [m], world frame, that cover the solid cells of a map and do not overlap.

    Runs of cells along x that are the same in successive rows become one rectangle.
    """
    solid = np.asarray(grid.occupied, dtype=bool)
    done: list[tuple[int, int, int, int]] = []
    open_: dict[tuple[int, int], int] = {}  # run of columns -> the row in which its rectangle begins
    for row in range(solid.shape[1]):
        runs = _runs(solid[:, row])
        kept = {run: open_.pop(run) for run in runs if run in open_}
        done.extend((begin, first, end, row) for (begin, end), first in open_.items())
        open_ = {run: kept.get(run, row) for run in runs}
    done.extend((begin, first, end, solid.shape[1]) for (begin, end), first in open_.items())
    cells = np.array(done, dtype=np.float64).reshape(-1, 2, 2)
    result: Floats = (cells * np.array(grid.cell) + np.array(grid.origin)).reshape(-1, 4)
    return result


def _runs(cells: np.ndarray) -> list[tuple[int, int]]:
    """Begin and end of each run of solid cells."""
    change = np.flatnonzero(np.diff(np.concatenate([[False], cells, [False]]).astype(np.int8)))
    return [(int(begin), int(end)) for begin, end in change.reshape(-1, 2)]


_THINNEST = 0.01
"""Smallest side of a box [m]: walls have no thickness."""


@dataclass(frozen=True)
class BoundingBox:
    """A box whose sides are along the axes of the body.

    Attributes:
        ahead: How far its middle is ahead of the origin of the body [m]: a car turns about its rear axle.
        left: How far its middle is to the left of it [m].
        length: Size along x [m].
        width: Size along y [m].
    """

    ahead: float
    left: float
    length: float
    width: float


def box_of(agent: SceneObject) -> BoundingBox:
    """The smallest such box around a footprint; around its circle without a footprint."""
    low, high = Outline(agent.parts).box()
    if not np.isfinite(low).all():
        low, high = np.full(2, -agent.radius), np.full(2, agent.radius)
    (ahead, left), (length, width) = (low + high) / 2, np.maximum(high - low, _THINNEST)
    return BoundingBox(float(ahead), float(left), float(length), float(width))


def numbers(*values: float) -> str:
    """Numbers separated by spaces, with twelve digits."""
    return " ".join(f"{value + 0.0:.12g}" for value in values)


def colored(color: tuple[float, float, float]) -> str:
    """An opaque color."""
    return numbers(*(round(value, 4) for value in color), 1)
