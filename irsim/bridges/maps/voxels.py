"""Triangles of a scene become solid spans of columns, whose tops a robot can stand on or not.

The method is Recast's height field (Mononen, 2009): each triangle is clipped to each column that it touches.
Heights are steps of millimeters instead of voxels, so that nothing depends on where a grid of heights begins.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.grid import Bools, Grid, Ints, Triangles, least, most, rows_of, slices
from irsim.common.arrays import Floats

__all__ = ["Spans", "Surfaces", "few_pieces", "floors_of", "spans_of", "walkable_of"]

_STEP = 0.005
"""Step of heights [m]; larger in scenes that are higher than a thousand meters."""
_BITS = 18
"""Bits of a height in the key of a piece: column, lower and upper height, walkable."""
_MAX_PIECES = 120_000_000
"""Pieces of triangles in columns, 8 bytes each."""
_LEVEL = 1.0
"""Steps of height within which a triangle is level."""
_AT_ONCE = 1 << 15
"""Triangles worked on at once."""


@dataclass(frozen=True)
class Spans:
    """Solid parts of columns, sorted by column and height.

    Attributes:
        column: (N,) column of the grid.
        low, high: (N,) heights [m].
        walkable: (N,) whether the top is flat enough to walk on.
    """

    column: Ints
    low: Floats
    high: Floats
    walkable: Bools


@dataclass(frozen=True)
class Surfaces:
    """Places where a robot can stand, sorted by column and height.

    Attributes:
        column: (M,) column of the grid.
        floor: (M,) height of the floor [m].
        ceiling: (M,) height of what is above [m], infinite under the sky.
    """

    column: Ints
    floor: Floats
    ceiling: Floats

    def some(self, which: Bools) -> Surfaces:
        """Some of them."""
        return Surfaces(self.column[which], self.floor[which], self.ceiling[which])


def few_pieces(triangles: Triangles, side: float) -> bool:
    """Whether triangles touch cells of a side [m] so rarely that :func:`spans_of` takes them.

    On average a triangle touches as many cells as its area, width and depth add up to, and one more (in cells).
    """
    total = 0.0
    for start in range(0, len(triangles), _AT_ONCE):
        corners = triangles[start : start + _AT_ONCE, :, :2].astype(np.float64) / side
        u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        area = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2
        size = most(corners) - least(corners)
        total += float((area + size[:, 0] + size[:, 1] + 1).sum())
    return total <= _MAX_PIECES


def spans_of(triangles: Triangles, grid: Grid, slope: float, climb: float) -> Spans:
    """Solid spans of the columns that triangles touch.

    Args:
        triangles: (T, 3, 3) corners x, y, z [m], z up, counterclockwise seen from outside.
        grid: The columns.
        slope: Largest slope that can be walked on [rad].
        climb: A top counts as walkable if a walkable surface lies at most this far below it [m].

    Raises:
        BridgeError: There are too many pieces.
    """
    bottom, top = float(triangles[..., 2].min()), float(triangles[..., 2].max())
    step = max(_STEP, (top - bottom) / ((1 << _BITS) - 4))
    parts: list[Ints] = []
    total = 0
    for start in range(0, len(triangles), _AT_ONCE):
        keys = _pieces(triangles[start : start + _AT_ONCE].astype(np.float64), grid, bottom, step, math.cos(slope))
        parts.append(keys)
        total += len(keys)
        if total > _MAX_PIECES:
            what = f"its triangles touch cells of {grid.resolution:g} m more than {_MAX_PIECES:,} times"
            raise BridgeError("bridge-file", what, f"give a coarser resolution: --resolution {grid.resolution * 3:g}")
    keys = np.concatenate(parts) if parts else np.zeros(0, np.int64)
    keys.sort()
    return _merged(keys, bottom, step, round(climb / step))


def _pieces(corners: Floats, grid: Grid, bottom: float, step: float, cosine: float) -> Ints:
    """Keys of the pieces of triangles in columns: column, lower height, upper height and whether it is walkable."""
    edge = corners[:, 1] - corners[:, 0]
    normal = np.cross(edge, corners[:, 2] - corners[:, 0])
    flat = normal[:, 2] > cosine * np.sqrt((normal**2).sum(axis=1))
    scaled = (corners - [grid.x, grid.y, bottom]) / [grid.resolution, grid.resolution, step]
    low, high = least(scaled), most(scaled)
    first = np.floor(low[:, :2]).astype(np.int64)
    small = (first == np.floor(high[:, :2])).all(axis=1)
    where = first[small, 0] * grid.ny + first[small, 1]
    result = [_packed(where, low[small, 2], high[small, 2], flat[small])]
    level = ~small & (high[:, 2] - low[:, 2] <= _LEVEL)  # such as floors, whose many cells all have one height
    for triangle, i, j, _ in rows_of(scaled[level][..., :2], at_centers=False):
        heights = low[level, 2][triangle], high[level, 2][triangle]
        result.append(_packed(i * grid.ny + j, *heights, flat[level][triangle]))
    tilted = ~small & ~level
    large, flat = scaled[tilted], flat[tilted]
    for triangle, i, j, _ in rows_of(large[..., :2], at_centers=False):
        result.append(_packed(i * grid.ny + j, *_heights(large[triangle], i, j), flat[triangle]))
    return np.concatenate(result)


def _packed(column: Ints, low: Floats, high: Floats, walkable: Bools) -> Ints:
    bottom, top = (low + 0.5).astype(np.int64), (high + 0.5).astype(np.int64)
    return (((column << _BITS) | bottom) << (_BITS + 1)) | (top << 1) | walkable


def _heights(corners: Floats, i: Ints, j: Ints) -> tuple[Floats, Floats]:
    """Lowest and highest point of triangles (N, 3, 3) within cells: on clipped edges, or at corners of the cell."""
    low, high = np.full(len(i), np.inf), np.full(len(i), -np.inf)
    x, y, z = (corners[..., k] for k in range(3))
    x, y = x - i[:, None], y - j[:, None]
    for a, b in ((0, 1), (1, 2), (2, 0)):
        begin, end = np.zeros(len(i)), np.ones(len(i))
        for value in (x, y):
            first, rise = value[:, a], value[:, b] - value[:, a]
            turn = 1.0 / np.where(rise == 0, 1e-300, rise)
            with np.errstate(over="ignore"):
                into, out = -first * turn, (1.0 - first) * turn
            begin = np.maximum(begin, np.minimum(into, out))
            end = np.minimum(end, np.maximum(into, out))
        inside = begin <= end
        climb = z[:, b] - z[:, a]
        for part in (begin, end):
            height = z[:, a] + np.clip(part, 0.0, 1.0) * climb
            low = np.where(inside, np.minimum(low, height), low)
            high = np.where(inside, np.maximum(high, height), high)
    double = (x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (x[:, 2] - x[:, 0]) * (y[:, 1] - y[:, 0])
    sign = np.sign(double)
    flat = np.abs(double) > 1e-9
    scale = 1.0 / np.where(flat, double, 1.0)
    for u, v in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)):
        parts = []
        for a, b in ((1, 2), (2, 0), (0, 1)):
            parts.append((x[:, a] - u) * (y[:, b] - v) - (x[:, b] - u) * (y[:, a] - v))
        inside = flat & (parts[0] * sign >= 0) & (parts[1] * sign >= 0) & (parts[2] * sign >= 0)
        height = (parts[0] * z[:, 0] + parts[1] * z[:, 1] + parts[2] * z[:, 2]) * scale
        low = np.where(inside, np.minimum(low, height), low)
        high = np.where(inside, np.maximum(high, height), high)
    bottom, top = least(z), most(z)
    missed = ~np.isfinite(low)  # a corner that rounding has moved out of the cell
    return np.clip(np.where(missed, bottom, low), bottom, top), np.clip(np.where(missed, top, high), bottom, top)


def _merged(keys: Ints, bottom: float, step: float, climb: int) -> Spans:
    """Pieces that touch become one span."""
    if not len(keys):
        return Spans(keys, np.zeros(0), np.zeros(0), np.zeros(0, bool))
    mask = (1 << _BITS) - 1
    column, low, high = keys >> (2 * _BITS + 1), (keys >> (_BITS + 1)) & mask, (keys >> 1) & mask
    reach = np.maximum.accumulate((column << _BITS) | high)
    first = np.ones(len(keys), bool)
    first[1:] = ((column[1:] << _BITS) | low[1:]) > reach[:-1] + 1
    starts = np.flatnonzero(first)
    top = np.maximum.reduceat(high, starts)
    number = np.cumsum(first) - 1
    flat = ((keys & 1) == 1) & (high >= top[number] - climb)
    walkable = np.logical_or.reduceat(flat, starts)
    return Spans(column[starts], np.float64(bottom) + low[starts] * step, np.float64(bottom) + top * step, walkable)


def walkable_of(spans: Spans, headroom: float, climb: float) -> Surfaces:
    """Tops of spans on which a robot can stand.

    Args:
        spans: Solid parts of columns.
        headroom: Free height that is needed above a floor [m].
        climb: Height up to which a thing that lies on a floor is part of it [m].
    """
    same = spans.column[1:] == spans.column[:-1]
    flat = spans.walkable.copy()
    flat[1:] |= same & spans.walkable[:-1] & (spans.high[1:] - spans.high[:-1] <= climb)
    ceiling = np.full(len(flat), np.inf)
    ceiling[:-1] = np.where(same, spans.low[1:], np.inf)
    which = flat & (ceiling - spans.high >= headroom)
    return Surfaces(spans.column[which], spans.high[which], ceiling[which])


def floors_of(triangles: Triangles, grid: Grid, headroom: float) -> Surfaces:
    """Surfaces of triangles that are floors already, in each cell whose center a triangle has.

    Args:
        triangles: (T, 3, 3) corners x, y, z [m], z up.
        grid: The columns.
        headroom: Free height above them [m]; surfaces of a column that are closer are one.
    """
    columns, heights = [np.zeros(0, np.int64)], [np.zeros(0)]
    for part in slices(np.ones(len(triangles), np.int64), _AT_ONCE):
        corners = (triangles[part] - [grid.x, grid.y, 0.0]) / [grid.resolution, grid.resolution, 1.0]
        for triangle, i, j, _ in rows_of(corners[..., :2], at_centers=True):
            inside = (i >= 0) & (j >= 0) & (i < grid.nx) & (j < grid.ny)
            triangle, i, j = triangle[inside], i[inside], j[inside]
            columns.append(i * grid.ny + j)
            heights.append(_plane(corners[triangle], i + 0.5, j + 0.5))
    column, height = np.concatenate(columns), np.concatenate(heights)
    order = np.lexsort((height, column))
    column, height = column[order], height[order]
    new = np.ones(len(column), bool)
    new[1:] = (column[1:] != column[:-1]) | (height[1:] - height[:-1] >= headroom)
    column, height = column[new], height[new]
    ceiling = np.full(len(column), np.inf)
    ceiling[:-1] = np.where(column[1:] == column[:-1], height[1:], np.inf)
    return Surfaces(column, height, ceiling)


def _plane(corners: Floats, x: NDArray[Any], y: NDArray[Any]) -> Floats:
    """Heights of triangles (N, 3, 3) at points inside of them."""
    a, u, v = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    double = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    flat = np.abs(double) > 1e-12
    scale = 1.0 / np.where(flat, double, 1.0)
    s = ((x - a[:, 0]) * v[:, 1] - (y - a[:, 1]) * v[:, 0]) * scale
    t = ((y - a[:, 1]) * u[:, 0] - (x - a[:, 0]) * u[:, 1]) * scale
    result: Floats = np.clip(
        a[:, 2] + np.where(flat, s * u[:, 2] + t * v[:, 2], 0.0), least(corners[..., 2]), most(corners[..., 2])
    )
    return result
