"""Where splats stand in the way: the ground plan of a scene of splats."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.grid import fitting_side
from irsim.bridges.splats.splats import Singles, Splats, covariance_of, scale_of
from irsim.common.arrays import Floats

__all__ = ["MAX_CELLS", "Footprints", "Plan", "PlanOptions", "find_floor", "ground_plan", "level_shares", "spread"]

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
    """Footprints of M splats on the ground.

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
    result = np.zeros(shape)
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
            result += sums.reshape(shape[0], _FINE, shape[1], _FINE).mean(axis=(1, 3))
        else:
            times = _FINE ** (int(number) - 1)
            result += sums.repeat(times, axis=0).repeat(times, axis=1)[: shape[0], : shape[1]]
        done += len(rows)
    return result.astype(np.float32)


def _told(progress: Callable[[int], None], before: int, done: int) -> None:
    progress(before + done)


def _levels(cover: Floats, finest: float) -> NDArray[np.int64]:
    """(M,) grid for each footprint, 0 is the finest: coarse enough for few cells, but not coarser than it is thin."""
    reach = _REACH * np.sqrt(np.maximum(cover[:, 0], cover[:, 2])) / finest
    apart = np.sqrt((cover[:, 0] - cover[:, 2]) ** 2 / 4 + cover[:, 1] ** 2)
    thin = np.sqrt(np.maximum((cover[:, 0] + cover[:, 2]) / 2 - apart, 0.0)) / finest
    for_few = _power(reach / _MAX_REACH)
    for_shape = np.maximum(_power(thin / _FINE), np.where(reach <= _MAX_LONG_REACH, 0, 1))
    result: NDArray[np.int64] = np.minimum(np.minimum(for_few, for_shape), _LEVELS)
    return result


def _power(ratio: Floats) -> NDArray[np.int64]:
    """Smallest power of the ratio of grids that is not below a ratio; 0 for ratios below 1."""
    result: NDArray[np.int64] = np.ceil(np.log(np.maximum(ratio, 1.0)) / np.log(_FINE) - 1e-9).astype(np.int64)
    return result


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


MAX_CELLS = 4_000_000
"""Most cells of a plan."""
_CHUNK = 1_000_000
"""Splats that are looked at at once, which bounds the memory."""
_NAMES = ("center", "share", "cover")
_BAND_REACH = 3.0
"""Standard deviations that a splat outside the band of heights may be away from it to count."""
_LEAST = 1e-3
"""Opacity within the band below which a splat adds nothing that counts."""
_EDGE_SHARE = 0.002
"""Share of all that stands in the way that may lie beyond each side of a map whose bounds are found."""
_MARGIN_CELLS = 4
_FLOOR_DEPTH_M = 0.25
"""How far below the floor its splats may lie [m]."""
_GROUND = 0.5
"""Sum of opacities in a cell from which on there is a floor."""
_FLOOR_BIN_M = 0.05
_FLOOR_SHARE = 0.3
"""Share of the most level area in one bin that the floor has at least; tables and shelves lie above it."""
_MOSTLY = 0.9
"""Share of splats that are round in a scene that was made with round ones."""


@dataclass(frozen=True)
class PlanOptions:
    """How a ground plan is made.

    Attributes:
        cell: Side of a cell [m]; None for the smallest usual one with which the plan is small enough.
        low, high: Heights above the floor between which things stand in the way [m].
        opacity: Splats with less opacity are left out.
        occupied: Sum of opacities in a cell from which on the cell is occupied.
        max_size: Splats whose standard deviation is larger are left out, such as a sky [m].
        bounds: Left, lower, right and upper bound of the plan [m]; None finds them.
        max_cells: Most cells of the plan.
    """

    cell: float | None = None
    low: float = 0.1
    high: float = 1.5
    opacity: float = 0.05
    occupied: float = 0.5
    max_size: float = 1.0
    bounds: tuple[float, float, float, float] | None = None
    max_cells: int = MAX_CELLS


@dataclass(frozen=True)
class Plan:
    """A ground plan.

    Attributes:
        density: (nx, ny) sum of opacity × share within the band × footprint at each cell; y grows upwards.
        occupied: (nx, ny) cells that stand in the way.
        unknown: (nx, ny) cells with neither a floor nor something in the way: outside, and within walls and cabinets.
        origin: Lower left corner [m], frame of irsim.
        cell: Side of a cell [m].
        used: Number of splats that stand in the way.
        too_large: Number of splats that were left out for their size.
    """

    density: Singles
    occupied: NDArray[np.bool_]
    unknown: NDArray[np.bool_]
    origin: tuple[float, float]
    cell: float
    used: int
    too_large: int


def level_shares(splats: Splats, turn: Floats | None = None) -> dict[str, float]:
    """How much of the surfaces is level along each axis of the scene: sums of opacity × area of flat splats.

    Args:
        splats: The scene.
        turn: (3, 3) rotation by which it is turned before.
    """
    covariance = covariance_of(splats.scale, splats.rotation, turn)
    along = np.diagonal(covariance, axis1=1, axis2=2)
    total = along.sum(axis=1)
    weight = splats.opacity * np.minimum(total, 1.0)
    return {name: float(weight[along[:, axis] < 0.1 * total].sum()) for axis, name in enumerate("xyz")}


def find_floor(splats: Splats, up: Floats, *, unit: float = 1.0, opacity: float = 0.05) -> float:
    """Height of the floor along a direction, in the unit of the scene.

    The floor is the lowest height at which there is much level area: splats that are thin along the direction. Where
    most splats are round, and so none is level, it is the lowest height at which there are many.

    Args:
        splats: The scene.
        up: (3,) unit vector that points up in the frame of the scene.
        unit: Length of a unit of the scene [m].
        opacity: Splats with less opacity are left out.

    Raises:
        BridgeError: No splat is level enough.
    """
    covariance = covariance_of(splats.scale, splats.rotation)
    along = np.einsum("i,nij,j->n", up, covariance.astype(np.float64), up)
    total = np.trace(covariance, axis1=1, axis2=2)
    seen = splats.opacity >= opacity
    level = (along < 0.1 * total) & seen
    if not level.any():
        round_ = (splats.scale.min(axis=1) > 0.5 * splats.scale.max(axis=1)) & seen
        level = round_ if round_.sum() > _MOSTLY * seen.sum() else level
    height = splats.center[level].astype(np.float64) @ up
    if not len(height):
        what = "the height of the floor was not found: no splat is level"
        fix = "check which axis is up (--up), or give the height of the floor: --height"
        raise BridgeError("bridge-file", what, fix)
    area = splats.opacity[level] * np.minimum(total[level], 1.0)
    low, high = np.percentile(height, [0.5, 99.5])
    step = _FLOOR_BIN_M / unit
    bins = max(1, math.ceil(min((high - low) / step, MAX_CELLS + 1.0))) + 1
    if bins > MAX_CELLS:
        raise BridgeError("bridge-file", "the scene is too high to find its floor", "give the height of the floor")
    at = np.clip((height - low) / step, 0, bins - 1).astype(np.int64)
    sums = np.bincount(at, weights=area, minlength=bins)
    both = sums + np.concatenate([sums[1:], [0.0]])  # a floor at the border of two bins
    first = int((both >= _FLOOR_SHARE * both.max()).argmax())
    near = (at == first) | (at == first + 1)
    order = np.argsort(height[near])
    share = np.cumsum(area[near][order])
    return float(height[near][order][np.searchsorted(share, share[-1] / 2)])


def ground_plan(
    splats: Splats,
    to_irsim: Floats,
    options: PlanOptions,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Plan:
    """The ground plan of a scene.

    Each splat adds its opacity, times the share of it within the band of heights, times its footprint: the normal
    distribution on the ground that it has seen from above, whose peak is 1. A cell has the mean of the sum over it.

    Args:
        splats: The scene.
        to_irsim: (4, 4) from the frame of the scene to irsim's, whose floor is at height 0.
        options: How it is made.
        progress: Callback ``(splats_done, splats_total)``; counts splats that stand in the way or show the floor.

    Raises:
        BridgeError: Nothing stands in the way, or the plan would be too large.
    """
    above, too_large = _standing(splats, to_irsim, options, options.low, options.high)
    if not len(above):
        what = f"no splat stands between {options.low:g} m and {options.high:g} m above the floor"
        raise BridgeError("bridge-file", what, "check which axis is up, the height of the floor and the band")
    below, _ = _standing(splats, to_irsim, options, -_FLOOR_DEPTH_M, options.low)
    origin, shape, cell = _extent(above, options)
    total = len(above) + len(below)
    density = spread(above, origin, shape, cell, lambda done: progress(done, total))
    ground = spread(below, origin, shape, cell, lambda done: progress(len(above) + done, total))
    occupied = density >= options.occupied
    return Plan(density, occupied, ~occupied & (ground < _GROUND), origin, cell, len(above), too_large)


def _standing(
    splats: Splats, to_irsim: Floats, options: PlanOptions, low: float, high: float
) -> tuple[Footprints, int]:
    """The footprints of what is between two heights, and the number of splats left out for their size."""
    size = splats.scale.max(axis=1) * scale_of(to_irsim)
    seen = splats.opacity >= options.opacity
    too_large = int((seen & (size > options.max_size)).sum())
    rows = np.flatnonzero(seen & (size <= options.max_size))
    parts = [Footprints(np.zeros((0, 2)), np.zeros(0), np.zeros((0, 3)))]
    for begin in range(0, len(rows), _CHUNK):
        part = rows[begin : begin + _CHUNK]
        at = splats.center[part].astype(np.float64) @ to_irsim[:3, :3].T + to_irsim[:3, 3]
        near = np.abs(at[:, 2] - np.clip(at[:, 2], low, high)) <= _BAND_REACH * size[part] + 1e-6
        part, at = part[near], at[near]
        cover = covariance_of(splats.scale[part], splats.rotation[part], to_irsim[:3, :3]).astype(np.float64)
        height = np.sqrt(np.maximum(cover[:, 2, 2], 1e-12))
        within = _normal_share((high - at[:, 2]) / height) - _normal_share((low - at[:, 2]) / height)
        share = splats.opacity[part] * within
        kept = share >= _LEAST
        cover = np.stack([cover[kept, 0, 0], cover[kept, 0, 1], cover[kept, 1, 1]], axis=1)
        parts.append(Footprints(at[kept, :2], share[kept], cover))
    return Footprints(*(np.concatenate([getattr(part, name) for part in parts]) for name in _NAMES)), too_large


def _normal_share(x: Floats) -> Floats:
    """Share of a standard normal distribution below x, to 1e-7 (Abramowitz and Stegun, 26.2.17)."""
    t = 1 / (1 + 0.2316419 * np.abs(x))
    tail = np.exp(-0.5 * np.minimum(x * x, 1400.0)) / math.sqrt(2 * math.pi)
    poly = t * (0.319381530 + t * (-0.356563782 + t * (1.781477937 + t * (-1.821255978 + t * 1.330274429))))
    result: Floats = np.where(x >= 0, 1 - tail * poly, tail * poly)
    return result


def _extent(above: Footprints, options: PlanOptions) -> tuple[tuple[float, float], tuple[int, int], float]:
    """Lower left corner [m], number of cells along x and y, and side of a cell [m]."""
    low, high = np.empty(2), np.empty(2)
    if options.bounds is not None:
        low, high = np.array(options.bounds[:2]), np.array(options.bounds[2:])
    else:
        for axis in range(2):
            order = np.argsort(above.center[:, axis])
            sums = np.cumsum(above.share[order])
            ends = np.searchsorted(sums, [_EDGE_SHARE * sums[-1], (1 - _EDGE_SHARE) * sums[-1]])
            low[axis], high[axis] = above.center[order[np.minimum(ends, len(order) - 1)], axis]
    most = min(MAX_CELLS, options.max_cells)
    margin = 0 if options.bounds is not None else _MARGIN_CELLS

    def fits(side: float) -> bool:
        return bool(_counts(low, high, side, margin)[1].prod() <= most)

    cell = fitting_side(options.cell, low, high, most, fits)
    low, cells = _counts(low, high, cell, margin)
    if not (cells.min() >= 1 and cells.prod() <= most):
        what = f"the map would have {cells[0]:,.0f} x {cells[1]:,.0f} cells; 1 to {most:,} are possible"
        raise BridgeError("bridge-file", what, "give other bounds, or larger cells with --resolution")
    return (round(float(low[0]), 9), round(float(low[1]), 9)), (int(cells[0]), int(cells[1])), cell


def _counts(low: Floats, high: Floats, cell: float, margin: int) -> tuple[Floats, Floats]:
    """Lower left corner of a plan [m], and number of cells along x and y, with a margin of cells."""
    if margin:
        low, high = np.floor((low - margin * cell) / cell) * cell, high + margin * cell
    return low, np.ceil((high - low) / cell - 1e-6)
