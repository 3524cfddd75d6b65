"""The grid that a scene is laid on, and which of its cells a triangle touches."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.base import BridgeError
from irsim.bridges.frames import turn_of
from irsim.common.arrays import Floats

__all__ = [
    "SIDES",
    "Bools",
    "Grid",
    "Ints",
    "Triangles",
    "clipped",
    "fits_into",
    "fitting_side",
    "grid_over",
    "least",
    "most",
    "rows_of",
    "side_notes",
    "slices",
    "spread",
    "turned",
]

Ints: TypeAlias = NDArray[np.int64]
"""Array of integers."""
Bools: TypeAlias = NDArray[np.bool_]
"""Array of truth values."""
Triangles: TypeAlias = NDArray[Any]
"""(T, 3, 3) corners x, y, z [m] of triangles, floats of single or double precision; z up."""
SIDES = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
"""Sides that cells get by themselves [m]: the first one with which a map is small enough."""
_MAX_COLUMNS = 1 << 26
"""Columns that a key of a piece has room for."""
_LEAST_CELLS = 16
"""Least bound on cells: a grid has at least three columns and rows, whatever its resolution."""
_CHUNK = 1 << 17
"""Pairs of triangle and cell that are worked on at once; their arrays fit into the cache of a processor."""


@dataclass(frozen=True)
class Grid:
    """Square cells over a rectangle; column i * ny + j stands for cell (i, j), i along x and j along y.

    Attributes:
        x, y: Lower left corner [m].
        resolution: Side of a cell [m].
        nx, ny: Number of cells along x and y.
    """

    x: float
    y: float
    resolution: float
    nx: int
    ny: int

    @property
    def columns(self) -> int:
        """Number of cells."""
        return self.nx * self.ny

    def column_at(self, x: float, y: float) -> int | None:
        """The column at a point [m]; None outside."""
        i, j = math.floor((x - self.x) / self.resolution), math.floor((y - self.y) / self.resolution)
        return i * self.ny + j if 0 <= i < self.nx and 0 <= j < self.ny else None

    def centers(self, columns: Ints) -> Floats:
        """(N, 2) centers of columns [m]."""
        i, j = np.divmod(columns, self.ny)
        return np.column_stack([self.x + (i + 0.5) * self.resolution, self.y + (j + 0.5) * self.resolution])


def clipped(triangles: Triangles, bounds: tuple[float, float, float, float]) -> Triangles:
    """The parts of triangles within left, lower, right and upper bounds [m], as triangles that face the same way."""
    for axis, limit, side in ((0, bounds[0], -1), (1, bounds[1], -1), (0, bounds[2], 1), (1, bounds[3], 1)):
        beyond = side * (triangles[..., axis].astype(np.float64) - limit)
        out = beyond > 0
        count = out.sum(axis=1)
        parts = [triangles[count == 0]]
        for number in (1, 2):
            cut = np.flatnonzero(count == number)
            single = out[cut] if number == 1 else ~out[cut]  # the corner that is alone on its side comes first
            order = (np.argmax(single, axis=1)[:, None] + [0, 1, 2]) % 3
            (a, b, c), far = triangles[cut[:, None], order].transpose(1, 0, 2), beyond[cut[:, None], order]
            ab = a + (b - a) * (far[:, 0] / (far[:, 0] - far[:, 1]))[:, None]
            ac = a + (c - a) * (far[:, 0] / (far[:, 0] - far[:, 2]))[:, None]
            ab[:, axis] = ac[:, axis] = limit
            corners = [(ab, b, c), (ab, c, ac)] if number == 1 else [(a, ab, ac)]
            parts += [np.stack(three, axis=1) for three in corners]
        triangles = np.concatenate(parts)
    return triangles


def turned(
    triangles: Triangles, rotate: tuple[float, float, float] | None, axes: Floats | None = None
) -> tuple[Triangles, Floats | None]:
    """Triangles that are turned by hand, and the rotation (3, 3) in the frame of their file.

    Args:
        triangles: (T, 3, 3) corners.
        rotate: Roll, pitch and yaw in the frame of the file [deg]; None if they stay as they are.
        axes: (3, 3) the axes of the triangles in the frame of the file; None if they are in that frame.
    """
    if rotate is None:
        return triangles, None
    turn = turn_of(*np.radians(rotate))
    own = turn if axes is None else axes.T @ turn @ axes
    return triangles.astype(np.float64) @ own.T, turn


def grid_over(low: Floats, high: Floats, resolution: float, max_cells: int, hint: str = "") -> Grid:
    """The grid over a rectangle with one cell more on each side; its lines are at multiples of the resolution.

    Args:
        low: (2,) lower left corner [m].
        high: (2,) upper right corner [m].
        resolution: Side of a cell [m].
        max_cells: Largest number of cells.
        hint: Further advice in the message about too many cells.

    Raises:
        BridgeError: There would be too many cells; the message has a resolution that fits.
    """
    if not fits_into(low, high, resolution, max_cells):
        size, limit = np.asarray(high, dtype=np.float64) - low, _limit(max_cells)
        what = (
            f"the scene is {size[0]:,.0f} m x {size[1]:,.0f} m, which is more than {limit:,} cells of {resolution:g} m"
        )
        side = fitting_side(None, low, high, max_cells)
        coarser = (
            f"a coarser resolution: --resolution {side:g}"
            if fits_into(low, high, side, max_cells)
            else "a smaller scene"
        )
        raise BridgeError("bridge-file", what, f"give {coarser}{hint}")
    first = np.floor(low / resolution) - 1
    last = np.floor(high / resolution) + 2
    count = (last - first).astype(np.int64)
    return Grid(float(first[0] * resolution), float(first[1] * resolution), resolution, int(count[0]), int(count[1]))


def fitting_side(
    given: float | None,
    low: Floats,
    high: Floats,
    max_cells: int,
    fits: Callable[[float], bool] = lambda side: True,
) -> float:
    """The side of the cells of a map over a rectangle [m].

    Args:
        given: The side that the user asks for; None for the smallest of :data:`SIDES` that fits, or its largest.
        low: (2,) lower left corner [m].
        high: (2,) upper right corner [m].
        max_cells: Largest number of cells.
        fits: Whether cells of a side satisfy a further bound.
    """
    if given is not None:
        return given
    return next((side for side in SIDES if fits_into(low, high, side, max_cells) and fits(side)), SIDES[-1])


def side_notes(given: float | None, side: float) -> list[str]:
    """Remarks on the side of the cells [m]: nothing if the user has asked for it, or if it is the usual one."""
    if given is not None or side == SIDES[0]:
        return []
    why = "so that walls and areas are kept" if side < SIDES[0] else "so that the map is not too large"
    return [f"cells are {side:g} m, {why}; --resolution sets another size"]


def fits_into(low: Floats, high: Floats, side: float, max_cells: int) -> bool:
    """Whether a grid over a rectangle has few enough cells."""
    size = np.asarray(high, dtype=np.float64) - low
    return bool((size[0] / side + 3) * (size[1] / side + 3) <= _limit(max_cells))


def _limit(max_cells: int) -> int:
    return max(_LEAST_CELLS, min(max_cells, _MAX_COLUMNS))


def least(corners: Floats) -> Floats:
    """Smallest values over the second of its axes, of length 3; NumPy's own reduction of so few is slow."""
    return np.minimum(np.minimum(corners[:, 0], corners[:, 1]), corners[:, 2])


def most(corners: Floats) -> Floats:
    """Largest values over the second of its axes, of length 3."""
    return np.maximum(np.maximum(corners[:, 0], corners[:, 1]), corners[:, 2])


def spread(counts: Ints) -> tuple[Ints, Ints]:
    """For items that stand for several: the number of the item, and the place within it, one after the other."""
    item = np.repeat(np.arange(len(counts)), counts)
    first = np.cumsum(counts) - counts
    return item, np.arange(len(item)) - first[item]


def slices(counts: Ints, most: int = _CHUNK) -> Iterator[slice]:
    """Consecutive slices of items whose counts add up to about ``most``; each has at least one item."""
    ends = np.cumsum(counts)
    start, total = 0, len(counts)
    while start < total:
        before = int(ends[start - 1]) if start else 0
        stop = max(start + 1, int(np.searchsorted(ends, before + most, side="right")))
        yield slice(start, stop)
        start = stop


def rows_of(corners: Floats, *, at_centers: bool) -> Iterator[tuple[Ints, Ints, Ints, Ints]]:
    """The cells of triangles, piece by piece.

    Args:
        corners: (T, 3, 2) corners in cells from the corner of the grid.
        at_centers: Whether a cell belongs to the triangle that has its center (of triangles that share an edge, only
            one has it), rather than to each that touches it.

    Yields:
        Triangle, i and j of each cell, and which row of the pieces it is from.
    """
    shift = 0.5 if at_centers else 0.0
    low = np.floor(least(corners[..., 1]) - shift).astype(np.int64) + (1 if at_centers else 0)
    high = np.floor(most(corners[..., 1]) - shift).astype(np.int64)
    counts = np.maximum(high - low + 1, 0)
    for part in slices(counts):
        triangle, along = spread(counts[part])
        triangle += part.start
        row = low[triangle] + along
        left, right = _range_in_row(corners[triangle], row + shift, row + (shift if at_centers else 1.0))
        if at_centers:
            first, last = np.ceil(left - 0.5).astype(np.int64), np.ceil(right - 0.5).astype(np.int64) - 1
        else:
            first, last = np.floor(left).astype(np.int64), np.floor(right).astype(np.int64)
        widths = np.maximum(last - first + 1, 0)
        for some in slices(widths):
            item, offset = spread(widths[some])
            item += some.start
            yield triangle[item], first[item] + offset, row[item], item


def _range_in_row(corners: Floats, low: NDArray[Any], high: NDArray[Any]) -> tuple[Floats, Floats]:
    """Smallest and largest x of triangles (N, 3, 2) between two values of y (N,)."""
    left, right = np.full(len(corners), np.inf), np.full(len(corners), -np.inf)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        xa, ya, xb, yb = corners[:, a, 0], corners[:, a, 1], corners[:, b, 0], corners[:, b, 1]
        swap = (yb < ya) | ((yb == ya) & (xb < xa))  # a shared edge is computed the same way from both sides
        xa, xb = np.where(swap, xb, xa), np.where(swap, xa, xb)
        ya, yb = np.where(swap, yb, ya), np.where(swap, ya, yb)
        hit = (ya <= high) & (yb >= low)
        rise = yb - ya
        slope = (xb - xa) / np.where(rise > 0, rise, 1.0)
        at_low = np.where((ya >= low) | (rise <= 0), xa, xa + (low - ya) * slope)
        at_high = np.where((yb <= high) | (rise <= 0), xb, xa + (high - ya) * slope)
        left = np.where(hit, np.minimum(left, np.minimum(at_low, at_high)), left)
        right = np.where(hit, np.maximum(right, np.maximum(at_low, at_high)), right)
    empty = ~np.isfinite(left)
    return np.where(empty, 0.0, left), np.where(empty, -1.0, right)
