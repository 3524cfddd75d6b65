"""Where splats stand in the way: the ground plan of a scene of splats."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.base import BridgeError
from irsim.bridges.splats.footprints import Footprints, spread
from irsim.bridges.splats.splats import Singles, Splats, covariance_of, scale_of
from irsim.common.arrays import Floats

__all__ = ["MAX_CELLS", "Plan", "PlanOptions", "find_floor", "ground_plan", "level_shares"]

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
        cell: Side of a cell [m].
        low, high: Heights above the floor between which things stand in the way [m].
        opacity: Splats with less opacity are left out.
        occupied: Sum of opacities in a cell from which on the cell is occupied.
        max_size: Splats whose standard deviation is larger are left out, such as those of a sky [m].
        bounds: Left, lower, right and upper bound of the plan [m]; None finds them.
        max_cells: Most cells of the plan.
    """

    cell: float = 0.05
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


def level_shares(splats: Splats) -> dict[str, float]:
    """How much of the surfaces is level along each axis of the scene: sums of opacity × area of flat splats."""
    covariance = covariance_of(splats.scale, splats.rotation)
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
        to_irsim: (4, 4) from the frame of the scene to that of irsim, whose floor is at height 0.
        options: How it is made.
        progress: Callback with the number of splats done and that of all that stand in the way or show the floor.

    Raises:
        BridgeError: Nothing stands in the way, or the plan would be too large.
    """
    above, too_large = _standing(splats, to_irsim, options, options.low, options.high)
    if not len(above):
        what = f"no splat stands between {options.low:g} m and {options.high:g} m above the floor"
        raise BridgeError("bridge-file", what, "check which axis is up, the height of the floor and the band")
    below, _ = _standing(splats, to_irsim, options, -_FLOOR_DEPTH_M, options.low)
    origin, shape = _extent(above, options)
    total = len(above) + len(below)
    density = spread(above, origin, shape, options.cell, lambda done: progress(done, total))
    ground = spread(below, origin, shape, options.cell, lambda done: progress(len(above) + done, total))
    occupied = density >= options.occupied
    return Plan(density, occupied, ~occupied & (ground < _GROUND), origin, options.cell, len(above), too_large)


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
    found: Floats = np.where(x >= 0, 1 - tail * poly, tail * poly)
    return found


def _extent(above: Footprints, options: PlanOptions) -> tuple[tuple[float, float], tuple[int, int]]:
    """Lower left corner, and number of cells along x and y."""
    cell = options.cell
    if options.bounds is not None:
        low, high = np.array(options.bounds[:2]), np.array(options.bounds[2:])
    else:
        margin = _MARGIN_CELLS * cell
        low, high = np.empty(2), np.empty(2)
        for axis in range(2):
            order = np.argsort(above.center[:, axis])
            sums = np.cumsum(above.share[order])
            ends = np.searchsorted(sums, [_EDGE_SHARE * sums[-1], (1 - _EDGE_SHARE) * sums[-1]])
            low[axis], high[axis] = above.center[order[np.minimum(ends, len(order) - 1)], axis] + [-margin, margin]
        low = np.floor(low / cell) * cell
    cells = np.ceil((high - low) / cell - 1e-6)
    most = min(MAX_CELLS, options.max_cells)
    if not (cells.min() >= 1 and cells.prod() <= most):
        what = f"the map would have {cells[0]:,.0f} x {cells[1]:,.0f} cells; 1 to {most:,} are possible"
        raise BridgeError("bridge-file", what, "give other bounds, or larger cells with --resolution")
    return (round(float(low[0]), 9), round(float(low[1]), 9)), (int(cells[0]), int(cells[1]))
