"""Sums of normal distributions on a grid: footprints of splats on the ground."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.splats.splats import Singles
from irsim.common.arrays import Floats

__all__ = ["Footprints", "spread"]

_FINE = 3
"""Ratio of the sides of cells of two grids; the finest one has this many cells in a cell of the plan along each axis,
so that a thin wall fills one cell rather than two."""
_MAX_REACH = 12
"""Cells that a footprint reaches at most; a larger one is spread on a coarser grid."""
_MAX_LONG_REACH = 36
"""The same for a long footprint that is thinner than coarser cells."""
_LEVELS = 12
_REACH = 3.0
"""Standard deviations after which a footprint is cut off."""
_PAIRS = 2_000_000
"""Pairs of splats and cells that are worked on at once, which bounds the memory."""


@dataclass(frozen=True)
class Footprints:
    """What M splats are on the ground.

    Attributes:
        center: (M, 2) x, y [m].
        share: (M,) height of the peaks.
        cover: (M, 3) covariances xx, xy, yy [m²].
    """

    center: Floats
    share: Floats
    cover: Floats

    def __len__(self) -> int:
        return len(self.share)


def spread(
    footprints: Footprints,
    origin: tuple[float, float],
    shape: tuple[int, int],
    cell: float,
    progress: Callable[[int], None] = lambda done: None,
) -> Singles:
    """Sum footprints on a grid.

    Args:
        footprints: The footprints.
        origin: Lower left corner of the grid [m].
        shape: Number of cells along x and y.
        cell: Side of a cell [m].
        progress: Callback with the number of footprints done.

    Returns:
        (nx, ny) mean of the sum over each cell.
    """
    level = _levels(footprints.cover, cell / _FINE)
    found = np.zeros(shape)
    done = 0
    for number in np.unique(level):
        rows = np.flatnonzero(level == number)
        part = Footprints(footprints.center[rows], footprints.share[rows], footprints.cover[rows])
        side = cell * float(_FINE) ** (int(number) - 1)
        size = (shape[0] * _FINE, shape[1] * _FINE) if number == 0 else tuple(
            -(-count // _FINE ** (int(number) - 1)) for count in shape
        )  # fmt: skip
        sums = _sums(part, origin, (size[0], size[1]), side, partial(_told, progress, done))
        if number == 0:
            found += sums.reshape(shape[0], _FINE, shape[1], _FINE).mean(axis=(1, 3))
        else:
            times = _FINE ** (int(number) - 1)
            found += sums.repeat(times, axis=0).repeat(times, axis=1)[: shape[0], : shape[1]]
        done += len(rows)
    return found.astype(np.float32)


def _told(progress: Callable[[int], None], before: int, done: int) -> None:
    progress(before + done)


def _levels(cover: Floats, finest: float) -> NDArray[np.int64]:
    """(M,) grid for each footprint, 0 is the finest: coarse enough for few cells, but not coarser than it is thin."""
    reach = _REACH * np.sqrt(np.maximum(cover[:, 0], cover[:, 2])) / finest
    apart = np.sqrt((cover[:, 0] - cover[:, 2]) ** 2 / 4 + cover[:, 1] ** 2)
    thin = np.sqrt(np.maximum((cover[:, 0] + cover[:, 2]) / 2 - apart, 0.0)) / finest
    for_few = _power(reach / _MAX_REACH)
    for_shape = np.maximum(_power(thin / _FINE), np.where(reach <= _MAX_LONG_REACH, 0, 1))
    found: NDArray[np.int64] = np.minimum(np.minimum(for_few, for_shape), _LEVELS)
    return found


def _power(ratio: Floats) -> NDArray[np.int64]:
    """Smallest power of the ratio of grids that is not below a ratio; 0 for ratios below 1."""
    found: NDArray[np.int64] = np.ceil(np.log(np.maximum(ratio, 1.0)) / np.log(_FINE) - 1e-9).astype(np.int64)
    return found


def _sums(
    footprints: Footprints,
    origin: tuple[float, float],
    shape: tuple[int, int],
    cell: float,
    progress: Callable[[int], None],
) -> Floats:
    """(nx, ny) sums at the centers of cells; footprints that reach equally many cells are worked on together."""
    cover, (nx, ny) = footprints.cover, shape
    sides = cell * cell / 12  # a cell as a distribution: footprints become means over cells
    xx, xy, yy = cover[:, 0] + sides, cover[:, 1], cover[:, 2] + sides
    area = np.maximum(xx * yy - xy * xy, 1e-18)
    own = np.sqrt(np.maximum(cover[:, 0] * cover[:, 2] - cover[:, 1] ** 2, 0.0))
    mass = footprints.share * (2 * np.pi * own / (cell * cell))  # in cells
    place = (footprints.center - np.array(origin)) / cell - 0.5
    reach = np.ceil(_REACH * np.sqrt(np.maximum(xx, yy)) / cell)
    inside = ((place >= -reach[:, None] - 1) & (place < np.array(shape) + reach[:, None])).all(axis=1)
    order = np.flatnonzero(inside)
    order = order[np.argsort(reach[order], kind="stable")]
    home = np.zeros(place.shape, dtype=np.int64)
    home[order] = np.rint(place[order]).astype(np.int64)
    sums = np.zeros(nx * ny)
    reaches = reach[order]
    done = 0
    while done < len(order):
        radius = int(reaches[done])
        last = int(np.searchsorted(reaches, radius, side="right"))
        part = order[done : min(last, done + max(1, _PAIRS // (2 * radius + 1) ** 2))]
        step = np.arange(-radius, radius + 1)
        ix, iy = (home[part, axis, None] + step for axis in (0, 1))
        dx, dy = (ix - place[part, :1]) * cell, (iy - place[part, 1:]) * cell
        a, b, c = (values[part, None] / area[part, None] for values in (yy, xy, xx))
        square = (a * dx * dx)[:, :, None] + (c * dy * dy)[:, None, :] - 2 * (b * dx)[:, :, None] * dy[:, None, :]
        added = np.exp(-0.5 * np.minimum(square, 50.0))
        added[square > _REACH**2] = 0.0
        total = added.sum(axis=(1, 2))
        added *= (mass[part] / np.where(total > 0, total, 1.0))[:, None, None]
        kept = (added > 0) & ((ix >= 0) & (ix < nx))[:, :, None] & ((iy >= 0) & (iy < ny))[:, None, :]
        flat = (ix[:, :, None] * ny + iy[:, None, :])[kept]
        np.add.at(sums, flat, added[kept])
        done += len(part)
        progress(done)
    return sums.reshape(nx, ny)
