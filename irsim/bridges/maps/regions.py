"""Which places of a scene are connected for a robot, and the levels that they form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.grid import Bools, Grid, Ints
from irsim.bridges.maps.source import Occupancy, known_free
from irsim.bridges.maps.voxels import Surfaces
from irsim.components.maps._site import OCCUPIED

__all__ = ["Level", "connected", "find_levels", "keep_part", "masked_regions", "numbered"]

_SMALLEST_AREA = 0.5
"""Connected surfaces smaller than this are not a level of their own [m²]."""
_SMALLEST_SHARE = 0.05
"""Share of the largest level that a level must have to be listed."""
_PEAK_SHARE = 0.1
"""Share of the largest floor's area that another floor of the same connected surface has."""
_BIN = 0.05
"""Width of the bins of heights [m]."""
_WINDOW = 5
"""Bins on each side that count for a floor."""


@dataclass
class Level:
    """A level of a scene: surfaces at one height.

    Attributes:
        height: Height of most of its largest connected surface [m].
        regions: (M,) number of the connected surface of each surface that belongs to the level; -1 for all other
            surfaces. Number 0 is the largest one.
        areas: Area of each connected surface [m²], the largest first.
        roof: Whether it lies above another level and has nothing above it: a roof, or the top floor of a file without
            ceilings.
    """

    height: float
    regions: Ints
    areas: list[float]
    roof: bool = False


def connected(count: int, a: Ints, b: Ints) -> Ints:
    """Number of the connected part of each node, which is its first node (by hooking and pointer jumping).

    Args:
        count: Number of nodes.
        a: (E,) one node of each edge.
        b: (E,) the other.

    References:
        Shiloach, Vishkin: An O(log n) parallel connectivity algorithm (1982).
    """
    joined = np.zeros(count, bool)
    joined[b[b == a + 1]] = True
    first_node = np.flatnonzero(~joined)  # of each run of nodes one after the other, of which grids have few
    run = np.cumsum(~joined) - 1
    result: Ints = first_node[_roots(len(first_node), run[a], run[b])[run]]
    return result


def _roots(count: int, a: Ints, b: Ints) -> Ints:
    """First node of the connected part of each node."""
    new = a != b
    new[1:] &= (a[1:] != a[:-1]) | (b[1:] != b[:-1])
    a, b = a[new], b[new]
    root = np.arange(count)
    while len(a):
        first, second = root[a], root[b]
        apart = first != second
        a, b = a[apart], b[apart]
        low, high = np.minimum(first[apart], second[apart]), np.maximum(first[apart], second[apart])
        root[high] = low
        while True:
            next_root = root[root]
            if (next_root == root).all():
                break
            root = next_root
    return root


def numbered(roots: Ints, columns: Ints) -> tuple[Ints, Ints]:
    """Number connected parts by their size, the largest first.

    Returns:
        (N,) number of each node's part, and (P,) in how many columns each part is.
    """
    _, part = np.unique(roots, return_inverse=True)
    order = np.lexsort((columns, part))
    new = np.ones(len(order), bool)
    new[1:] = (part[order][1:] != part[order][:-1]) | (columns[order][1:] != columns[order][:-1])
    size = np.bincount(part[order][new], minlength=int(part.max(initial=-1)) + 1)
    ranks = np.argsort(-size, kind="stable")
    number = np.empty(len(ranks), np.int64)
    number[ranks] = np.arange(len(ranks))
    return number[part], size[ranks]


def masked_regions(free: Bools) -> tuple[Ints, Ints]:
    """Connected parts of cells of a map, through sides.

    Returns:
        (nx, ny) number of each cell's part, the largest is 0, and -1 where not free; (P,) cells of each part.
    """
    index = np.full(free.shape, -1)
    index[free] = np.arange(int(free.sum()))
    along_x, along_y = free[1:] & free[:-1], free[:, 1:] & free[:, :-1]
    a = np.concatenate([index[:-1][along_x], index[:, :-1][along_y]])
    b = np.concatenate([index[1:][along_x], index[:, 1:][along_y]])
    part, sizes = numbered(connected(int(free.sum()), a, b), np.arange(int(free.sum())))
    index[free] = part
    return index, sizes


def keep_part(result: Occupancy, seed_point: tuple[float, float] | None) -> None:
    """Note how large the connected free parts of a map are, and keep only the one at a seed point.

    Raises:
        BridgeError: The seed point is not free.
    """
    free = known_free(result.values)
    number, sizes = masked_regions(free)
    result.regions = [float(size) * result.grid.resolution**2 for size in sizes]
    if seed_point is None:
        return
    x, y = seed_point
    column = result.grid.column_at(x, y)
    kept = -1 if column is None else int(number.reshape(-1)[column])
    if kept < 0:
        what = f"the seed point ({x:g}, {y:g}) is not free in this map"
        raise BridgeError("bridge-file", what, "give a free place, or no seed point")
    result.kept = kept
    result.values = np.where(free & (number != kept), OCCUPIED, result.values)


def edges(surfaces: Surfaces, grid: Grid, climb: float, headroom: float) -> tuple[Ints, Ints]:
    """Pairs of surfaces in columns side by side between which a robot can move."""
    count = np.bincount(surfaces.column, minlength=grid.columns)
    first = np.cumsum(count) - count
    pairs: list[tuple[Ints, Ints]] = []
    for step, limit in ((1, grid.ny - 1), (grid.ny, None)):
        there = surfaces.column + step
        inside = there < grid.columns if limit is None else surfaces.column % grid.ny < limit
        node = np.flatnonzero(inside)
        target = there[node]
        for k in range(int(count.max(initial=0))):
            some = k < count[target]
            node, target = node[some], target[some]
            other = first[target] + k
            level = np.abs(surfaces.floor[node] - surfaces.floor[other]) <= climb
            below = np.minimum(surfaces.ceiling[node], surfaces.ceiling[other])
            high = below - np.maximum(surfaces.floor[node], surfaces.floor[other]) >= headroom
            pairs.append((node[level & high], other[level & high]))
    if not pairs:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    return np.concatenate([a for a, _ in pairs]), np.concatenate([b for _, b in pairs])


def find_levels(surfaces: Surfaces, grid: Grid, climb: float, headroom: float) -> list[Level]:
    """Levels from the lowest to the highest.

    A connected surface that lies above itself, as two floors joined by stairs do, is cut in the middle between its
    floors. Surfaces at about the same height are one level, such as rooms behind closed doors, or a bed.
    """
    a, b = edges(surfaces, grid, climb, headroom)
    region, sizes = numbered(connected(len(surfaces.column), a, b), surfaces.column)
    cell = grid.resolution**2
    layer = np.zeros(len(region), np.int64)
    for k in np.flatnonzero(sizes * cell >= _SMALLEST_AREA).tolist():
        members = np.flatnonzero(region == k)
        if len(members) > sizes[k]:
            layer[members] = _layers(surfaces.floor[members], headroom)
    if layer.any():
        inside = layer[a] == layer[b]
        region, sizes = numbered(connected(len(region), a[inside], b[inside]), surfaces.column)
    levels: list[tuple[float, list[int]]] = []
    order = np.argsort(region, kind="stable")
    starts = np.cumsum(np.bincount(region, minlength=len(sizes))) - np.bincount(region, minlength=len(sizes))
    for k in range(len(sizes)):
        if sizes[k] * cell < _SMALLEST_AREA:
            break
        stop = starts[k + 1] if k + 1 < len(sizes) else len(order)
        height = round(float(np.median(surfaces.floor[order[starts[k] : stop]])), 6) + 0.0
        near = [regions for other, regions in levels if abs(height - other) <= 0.55 * headroom]
        if near:
            near[0].append(k)
        elif sizes[k] >= _SMALLEST_SHARE * sizes[0]:
            levels.append((height, [k]))
    result = [_level(height, members, region, sizes * cell) for height, members in sorted(levels)]
    for level in result:
        level.roof = _is_roof(level, result, surfaces, grid)
    return result


def _layers(floor: np.ndarray, headroom: float) -> Ints:
    """Which floor of a connected surface is nearest; floors are heights at which much of its area lies."""
    bins = ((floor - floor.min()) / _BIN).astype(np.int64)
    area = np.convolve(np.bincount(bins), np.ones(2 * _WINDOW + 1), mode="same").astype(float)
    peaks: list[int] = []
    rest = area.copy()
    while rest.max() >= max(1.0, _PEAK_SHARE * area.max()):
        best = int(np.argmax(rest))
        peaks.append(best)
        away = int(headroom / _BIN)
        rest[max(0, best - away) : best + away + 1] = 0
    heights = np.sort(np.array(peaks))
    nearest: Ints = np.searchsorted((heights[1:] + heights[:-1]) / 2, bins)
    return nearest


def _level(height: float, members: list[int], region: Ints, areas: np.ndarray) -> Level:
    number = np.full(len(areas), -1)
    number[members] = np.arange(len(members))
    return Level(height, number[region], [float(areas[k]) for k in members])


def _is_roof(level: Level, levels: list[Level], surfaces: Surfaces, grid: Grid) -> bool:
    """Whether most of a level's largest surface is under the sky and above another level.

    Cells beside the level below count, too: they have walls, which take much of a floor if cells are large.
    """
    own = level.regions == 0
    if np.isfinite(surfaces.ceiling[own]).mean() >= 0.5:
        return False
    for other in levels:
        if other.height < level.height:
            below = np.zeros(grid.columns, bool)
            below[surfaces.column[other.regions >= 0]] = True
            below = np.pad(below.reshape(grid.nx, grid.ny), 1)
            rows = below[:-2] | below[1:-1] | below[2:]
            near = rows[:, :-2] | rows[:, 1:-1] | rows[:, 2:]
            if near.reshape(-1)[surfaces.column[own]].mean() >= 0.5:
                return True
    return False
