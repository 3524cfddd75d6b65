"""``splats``: scenes of Gaussian splats (``.ply``): what stands between floor and headroom is occupied."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.frames import angles_of, axes_of, inverse, turn_between, turn_of
from irsim.bridges.maps.apart import read_apart
from irsim.bridges.maps.grid import Grid, side_notes
from irsim.bridges.maps.occupancy import cropped
from irsim.bridges.maps.regions import masked_regions
from irsim.bridges.maps.sidecar import scene_transform
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Kind, Occupancy, unusable
from irsim.bridges.ply import read_header
from irsim.bridges.splats.occupancy import Plan, PlanOptions, find_floor, ground_plan, level_shares
from irsim.bridges.splats.reading import SPLATS_FIX, read_splats
from irsim.bridges.splats.splats import Splats, moved
from irsim.bridges.splats.upright import upward_of
from irsim.common.arrays import Floats
from irsim.common.extras import require
from irsim.components.maps._site import FREE, OCCUPIED, UNKNOWN

__all__ = ["KIND", "unpacked_splats"]

_FRAMES = {"z": "irsim", "y": "habitat_yup", "-y": "colmap"}
_SMALLEST_AREA_M2 = 0.5
_MORE = 1.1
"""How much more of the surfaces must be level along another axis before a note says so."""
_MAX_REGIONS = 50
_LEVEL_DEG = 0.3
"""Angle from which on a scene counts as tilted."""


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> Occupancy:
    """The ground plan of a scene of splats.

    Raises:
        BridgeError: The file is damaged, nothing stands in the way, or there is no floor.
    """
    if options.level:
        raise BridgeError("bridge-file", "a map of splats has one level, 0", "give its floor with --height instead")
    splats = unpacked_splats(path, limits)
    up = "z" if options.up == "auto" else options.up
    frame, unit = _FRAMES[up], options.meters_per_unit or 1.0
    turn, notes = _upright(splats, axes_of(frame)[:, 2], unit, options)
    if options.up == "auto":
        notes += _doubts(level_shares(splats, turn))
    if options.height is not None:
        height = options.height
    else:
        height = find_floor(splats, turn.T @ axes_of(frame)[:, 2], unit=unit, opacity=options.opacity) * unit
        height = round(height, 6)
        notes.append(f"the floor was found at {height:.2f} m along the axis that points up; --height corrects it")
    wanted = PlanOptions(
        cell=options.resolution,
        low=options.climb,
        high=max(options.headroom, options.climb + 0.01),
        opacity=options.opacity,
        bounds=options.bounds,
        max_cells=limits.cells,
    )
    plan = ground_plan(splats, inverse(scene_transform(frame, height, unit, turn)), wanted)
    if plan.too_large:
        notes.append(f"{plan.too_large:,} splats were left out because they are larger than {wanted.max_size:g} m")
    notes += side_notes(options.resolution, plan.cell)
    grid = Grid(*plan.origin, plan.cell, *plan.occupied.shape)
    values, regions, kept = _kept(plan, grid, options, len(splats))
    areas = [round(float(cells) * grid.resolution**2, 4) for cells in regions[:_MAX_REGIONS]]
    result = Occupancy(values, grid, frame, height, unit, 0, [(height, areas[0], False)], areas, kept, notes=notes)
    result.turn = turn
    return result if options.bounds is not None else cropped(result)


def _upright(splats: Splats, up: Floats, unit: float, options: ImportOptions) -> tuple[Floats, list[str]]:
    """(3, 3) the rotation that makes a scene upright, or the one that was asked for, and what to say about it."""
    turn = np.eye(3) if options.rotate is None else turn_of(*np.radians(options.rotate))
    upward = upward_of(splats, turn.T @ up, unit=unit, opacity=options.opacity)
    if upward is None or upward.tilt < _LEVEL_DEG:
        return turn, []
    upright = turn_between(turn @ upward.direction, up) @ turn
    words = ",".join(f"{angle:.2f}" for angle in np.degrees(angles_of(upright)))
    if options.rotate is not None:
        return turn, [f"the scene is still tilted by {upward.tilt:.1f}°: --rotate={words} turns it upright"]
    said = f"the scene is tilted by {upward.tilt:.1f}°, and was turned upright, as by --rotate={words}"
    return upright, [f"{said}; --rotate 0,0,0 leaves it as it is"]


def unpacked_splats(path: Path, limits: ImportLimits) -> Splats:
    """The splats of a file; a process of its own unpacks packed ones.

    Raises:
        BridgeError: The file is damaged, or no library reads it.
        ExtraError: The library that reads it is missing.
    """
    suffix = path.suffix.lower().lstrip(".")
    if suffix == "ply" and read_header(path, SPLATS_FIX).element("chunk") is None:
        return read_splats(path)
    if suffix == "lcc":
        fix = "convert it: npx @playcanvas/splat-transform scene.lcc scene.ply"
        raise unusable(path, "no library reads its format", fix)
    require("mesh", "gaussforge")
    form = "compressed.ply" if suffix == "ply" else suffix
    content, _ = read_apart(path, f"{__package__}._splat_process", limits, {"format": form})
    with tempfile.TemporaryDirectory(prefix="irsim-splats-") as folder:
        plain = Path(folder, path.stem[:100] + ".ply")
        plain.write_bytes(content.tobytes())
        splats = read_splats(plain)
    return (
        moved(splats, np.diag([1.0, -1.0, -1.0, 1.0])) if suffix == "spz" else splats
    )  # whose y and z point backwards


def _kept(plan: Plan, grid: Grid, options: ImportOptions, count: int) -> tuple[Floats, list[int], int]:
    """Values of the cells, number of cells of each connected part of the floor, and the part that is free."""
    numbers, sizes = masked_regions(~plan.occupied & ~plan.unknown)
    if not len(sizes) or sizes[0] * grid.resolution**2 < _SMALLEST_AREA_M2:
        what = f"its {count:,} splats show no connected floor of {_SMALLEST_AREA_M2:g} m²"
        fix = "check which axis points up (--up y, z or -y), --height of the floor, --meters-per-unit and --climb"
        raise BridgeError("bridge-file", what, fix)
    kept = 0
    if options.seed_point is not None:
        column = grid.column_at(*options.seed_point)
        kept = -1 if column is None else int(numbers.reshape(-1)[column])
        if kept < 0:
            x, y = options.seed_point
            what = f"there is no floor at the seed point ({x:g}, {y:g})"
            raise BridgeError("bridge-file", what, "give another point with --seed-point, or leave it out")
    values = np.full(plan.occupied.shape, UNKNOWN)
    values[plan.occupied] = OCCUPIED
    values[numbers == kept] = FREE
    return values, [int(size) for size in sizes], kept


def _doubts(shares: dict[str, float]) -> list[str]:
    """A note if the axis that is taken to point up is not the one along which most is level."""
    if shares["y"] > _MORE * shares["z"]:
        return ["most surfaces are level along y: if y points up, give --up y; if it points down, --up=-y"]
    return []


def _may_be_splats(head: bytes) -> bool:
    marks = (b" f_dc_0\n", b" f_dc_0\r", b" scale_0\n", b" packed_position\n")
    return head.startswith(b"ply") and b"element face" not in head and any(mark in head for mark in marks)


KIND = Kind(
    name="splats",
    title="a scene of Gaussian splats",
    suffixes=(".ply",),
    accepts=_may_be_splats,
    read=read,
    unused=("slope", "ground", "lanes", "root"),
)
