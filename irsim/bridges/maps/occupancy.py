"""From a scene to the map of one of its levels: free, occupied and unknown cells."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.grid import SIDES, Bools, Grid, Ints, Triangles, clipped, fitting_side, grid_over, side_notes
from irsim.bridges.maps.regions import Level, find_levels
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Occupancy, SceneTriangles
from irsim.bridges.maps.voxels import Spans, Surfaces, few_pieces, floors_of, spans_of, walkable_of
from irsim.common.arrays import Floats
from irsim.components.maps._site import FREE, OCCUPIED, UNKNOWN

__all__ = ["cropped", "eroded", "occupancy_of", "within"]

_UNITS = ", or its unit if that is not the meter: --meters-per-unit 0.001 for millimeters, 0.01 for centimeters"
_MARGIN = 10
"""Cells that are kept around the free ones."""
_BEYOND = 1.0
"""Width of a ground around the scene that it is given to [m]."""
COARSE, FINE = 0.25, 0.1
"""Sides of cells in which walls may hide rooms, and in which they do not [m]."""


def occupancy_of(scene: SceneTriangles, options: ImportOptions, limits: ImportLimits) -> Occupancy:
    """The map of one level of a scene.

    Raises:
        BridgeError: The scene has no place to stand, not that level, or too many cells.
    """
    headroom = options.headroom if scene.headroom is None else scene.headroom
    climb = options.climb if scene.climb is None else scene.climb
    if options.bounds is not None:
        scene = _within_bounds(scene, options.bounds)
    if options.ground is not None and len(scene.solid):
        scene = replace(scene, solid=_with_ground(scene.solid, options.ground, options.bounds))
    parts = [part.reshape(-1, 3) for part in (scene.solid, scene.floors, scene.barred) if len(part)]
    if not parts:
        raise _empty("it has no triangles", "export the scene with its meshes")
    low, high = (op([op(part[:, :2], axis=0) for part in parts], axis=0) for op in (np.min, np.max))
    side = fitting_side(options.resolution, low, high, limits.cells, partial(few_pieces, scene.solid))
    hint = f", a part of it with --bounds{_UNITS if len(scene.solid) else ''}"
    grid = grid_over(low, high, side, limits.cells, hint)
    spans = None
    if len(scene.solid):
        spans = spans_of(scene.solid, grid, math.radians(options.slope), climb)
        surfaces = walkable_of(spans, headroom, climb)
    else:
        surfaces = floors_of(scene.floors, grid, headroom)
    levels = find_levels(surfaces, grid, climb, headroom) if len(surfaces.column) else []
    if not levels:
        what = f"it has no connected floor of 0.5 m² with {headroom:g} m of free height"
        if options.resolution is None and side != SIDES[0]:
            size = high - low
            what += f" in cells of {side:g} m, the smallest that fit over its {size[0]:,.0f} m x {size[1]:,.0f} m"
            raise _empty(what, f"give {hint.removeprefix(', ')}")
        fix = "check which axis points up (--up y or z), and the unit (--meters-per-unit); or try less --headroom"
        if len(scene.solid) and options.ground is None:
            fix += f"; --ground {scene.solid[..., 2].min():.3g} puts a floor below all of it"
        raise _empty(what, fix)
    number = _chosen(levels, _at_seed(levels, surfaces, grid, options), options)
    level = levels[number]
    region = _region(level, surfaces, grid, options)
    values = _values(level.regions, region, surfaces, spans, grid, climb, headroom)
    if len(scene.barred):
        barred = floors_of(scene.barred, grid, headroom).column
        flat = values.reshape(-1)
        flat[barred[flat[barred] == UNKNOWN]] = OCCUPIED
    listed = [(one.height, one.areas[0], one.roof) for one in levels]
    result = Occupancy(values, grid, scene.frame, level.height, scene.meters_per_unit, number, listed, level.areas)
    result.kept, result.radius, result.notes = (
        region,
        scene.radius,
        [*scene.notes, *side_notes(options.resolution, side)],
    )
    result.headroom, result.climb, result.turn = scene.headroom, scene.climb, scene.turn
    if spans is not None and len(levels) > 1 and options.level is None and options.height is None:
        result.notes.append(f"level {number} of {len(levels)} was taken; --list-levels lists them, --level picks one")
    if spans is not None and side > COARSE and _may_be_roof(level, surfaces, spans, options, headroom):
        result.notes.append(
            f"this level at {level.height:.2f} m is under the sky, and the scene goes on below it: cells of "
            f"{side:g} m are too large for rooms, whose walls fill them, so this may be a roof; try "
            f"--resolution {FINE:g}"
        )
    return cropped(result)


def _with_ground(solid: Triangles, height: float, bounds: tuple[float, float, float, float] | None) -> Triangles:
    """Triangles and a flat ground below all of them, or within bounds [m]."""
    low, high = solid.min(axis=(0, 1))[:2] - _BEYOND, solid.max(axis=(0, 1))[:2] + _BEYOND
    if bounds is not None:
        low, high = np.array(bounds[:2]), np.array(bounds[2:])
    corners = np.array([[*low, height], [high[0], low[1], height], [*high, height], [low[0], high[1], height]])
    return np.concatenate([solid, corners[[[0, 1, 2], [0, 2, 3]]].astype(solid.dtype)])


def _within_bounds(scene: SceneTriangles, bounds: tuple[float, float, float, float]) -> SceneTriangles:
    """The part of a scene between bounds of x and y [m]."""
    solid, floors, barred = (clipped(part, bounds) for part in (scene.solid, scene.floors, scene.barred))
    if not len(solid) + len(floors) + len(barred):
        raise _empty("it has nothing within the bounds", "give other --bounds, or leave them out")
    return replace(scene, solid=solid, floors=floors, barred=barred)


def _may_be_roof(
    level: Level, surfaces: Surfaces, spans: Spans, options: ImportOptions, headroom: float
) -> bool:  # fmt: skip
    """Whether cells are so large that floors below a level under the sky may have disappeared."""
    if options.level is not None or options.height is not None:
        return False
    own = level.regions == 0
    if np.isfinite(surfaces.ceiling[own]).mean() >= 0.5:
        return False
    deep = np.unique(spans.column[spans.low < level.height - headroom])
    return bool(np.isin(surfaces.column[own], deep).mean() >= 0.5)


def _at_seed(levels: list[Level], surfaces: Surfaces, grid: Grid, options: ImportOptions) -> list[int]:
    """Numbers of the levels that have a floor at the seed point; all without one."""
    if options.seed_point is None:
        return list(range(len(levels)))
    here = surfaces.column == grid.column_at(*options.seed_point)
    result = [k for k, level in enumerate(levels) if (level.regions[here] >= 0).any()]
    return result or list(range(len(levels)))


def _chosen(levels: list[Level], candidates: list[int], options: ImportOptions) -> int:
    """Number of the level that is asked for, or of the largest candidate that is not a roof."""
    if options.level is not None and options.height is not None:
        raise BridgeError("bridge-file", "level and height both pick a level", "give one of --level and --height")
    if options.level is not None:
        if options.level >= len(levels):
            listed = ", ".join(f"{k} at {level.height:.2f} m" for k, level in enumerate(levels))
            what = f"there is no level {options.level}; levels are {listed}"
            raise BridgeError("bridge-file", what, "give one of them")
        return options.level
    wanted = options.ground if options.height is None else options.height
    if wanted is not None:
        return min(range(len(levels)), key=lambda k: abs(levels[k].height - wanted))
    return max(candidates, key=lambda k: (not levels[k].roof, levels[k].areas[0]))


def _region(level: Level, surfaces: Surfaces, grid: Grid, options: ImportOptions) -> int:
    """Number of the connected part at the seed point; 0 without one."""
    if options.seed_point is None:
        return 0
    x, y = options.seed_point
    column = grid.column_at(x, y)
    result = level.regions[(surfaces.column == column) & (level.regions >= 0)] if column is not None else []
    if not len(result):
        own = level.regions == 0
        centers = grid.centers(surfaces.column[own])
        near = centers[np.argmin(((centers - [x, y]) ** 2).sum(axis=1))]
        what = f"there is no floor of this level at the seed point ({x:g}, {y:g})"
        fix = f"the nearest place of its largest part is --seed-point {near[0]:.2f},{near[1]:.2f}"
        raise BridgeError("bridge-file", what, fix)
    return int(result[0])


def _values(
    regions: Ints, chosen: int, surfaces: Surfaces, spans: Spans | None, grid: Grid, climb: float, headroom: float
) -> Floats:
    """(nx, ny) free where the chosen part is, occupied where something else is known to be, else unknown."""
    own = regions == chosen
    values = np.full(grid.columns, UNKNOWN)
    if spans is not None:
        floor = np.full(grid.columns, np.nan)
        floor[surfaces.column[own]] = surfaces.floor[own]
        near = _filled(floor.reshape(grid.nx, grid.ny)).reshape(-1)
        base = near[spans.column]
        below = spans.low < base + headroom
        values[spans.column[below]] = OCCUPIED
        away = ~own & (np.abs(surfaces.floor - near[surfaces.column]) <= max(climb, 0.02))
        values[surfaces.column[away]] = UNKNOWN  # a floor that cannot be reached, such as that inside of a wall
        blocked = below & (spans.high > base + climb)
        values[spans.column[blocked]] = OCCUPIED
    values[surfaces.column[own]] = FREE
    return values.reshape(grid.nx, grid.ny)


def _filled(values: Floats) -> Floats:
    """Fill cells without a value with the mean of ever larger blocks around them."""
    if not np.isnan(values).any() or min(values.shape) == 0 or values.size == 1:
        return np.nan_to_num(values)
    nx, ny = values.shape
    padded = np.full(((nx + 1) // 2 * 2, (ny + 1) // 2 * 2), np.nan)
    padded[:nx, :ny] = values
    blocks = padded.reshape(padded.shape[0] // 2, 2, padded.shape[1] // 2, 2)
    count = (~np.isnan(blocks)).sum(axis=(1, 3))
    total = np.nansum(blocks, axis=(1, 3))
    coarse = _filled(np.where(count > 0, total / np.maximum(count, 1), np.nan))
    fine = np.repeat(np.repeat(coarse, 2, axis=0), 2, axis=1)[:nx, :ny]
    return np.where(np.isnan(values), fine, values)


def within(marked: Bools, cells: float) -> Bools:
    """Which cells lie within a distance [cells] of a marked one or of the edge of the array."""
    reach = math.floor(cells)
    padded = np.pad(marked, reach + 1, constant_values=True)
    result = np.zeros_like(marked)
    nx, ny = marked.shape
    sums = np.zeros((padded.shape[0], padded.shape[1] + 1), np.int32)
    np.cumsum(padded, axis=1, out=sums[:, 1:])
    for step in range(-reach, reach + 1):
        half = math.floor(math.sqrt(cells * cells - step * step))
        rows = sums[reach + 1 + step : reach + 1 + step + nx]
        middle = reach + 1
        result |= rows[:, middle + half + 1 : middle + half + 1 + ny] > rows[:, middle - half : middle - half + ny]
    return result


def eroded(values: Floats, cells: float) -> Floats:
    """Values whose free cells keep a distance [cells] from all others; free cells that are closer become occupied."""
    if cells <= 0:
        return values
    free = values == FREE
    return np.where(free & within(~free, cells), OCCUPIED, values)


def cropped(occupancy: Occupancy) -> Occupancy:
    """The part of a map around its free cells."""
    i, j = np.nonzero(occupancy.values == FREE)
    if not len(i):
        return occupancy
    first = max(int(i.min()) - _MARGIN, 0), max(int(j.min()) - _MARGIN, 0)
    last = min(int(i.max()) + _MARGIN + 1, occupancy.grid.nx), min(int(j.max()) + _MARGIN + 1, occupancy.grid.ny)
    grid, side = occupancy.grid, occupancy.grid.resolution
    x, y = (round(start / side + k) * side for start, k in zip((grid.x, grid.y), first, strict=True))
    occupancy.values = np.ascontiguousarray(occupancy.values[first[0] : last[0], first[1] : last[1]])
    occupancy.grid = Grid(round(x, 9), round(y, 9), side, *occupancy.values.shape)
    return occupancy


def _empty(what: str, fix: str) -> BridgeError:
    return BridgeError("bridge-file", f"the scene is not usable: {what}", fix)
