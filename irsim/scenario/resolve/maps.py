"""Finds and reads the map of a scenario and lays it over the world, or reports why that fails."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path as FilePath
from typing import Any

from irsim.components.maps._grid import MapGrid, map_grid
from irsim.components.maps._site import MapProblem, MapSite, Noise, Raster, bundled_map, bundled_names
from irsim.options.registry import MAPS
from irsim.scenario.limits import Limits
from irsim.scenario.locate import why_outside
from irsim.scenario.messages.findings import Finding, error, hint, warning
from irsim.scenario.model.world import WorldModel

__all__ = ["LoadedMap", "load_map"]

_PATH = ("world", "obstacle_map")
_WARNED = ("map-transparent",)
"""Notes about maps that are warnings."""


@dataclass(frozen=True)
class LoadedMap:
    """Result of loading ``world.obstacle_map``.

    Attributes:
        grid: The map; None without one.
        world: The world; it has the extent of the map if the map prescribes one.
        findings: Errors, warnings and hints about the map.
        files: Name in the scenario -> path of the file that was read.
    """

    grid: MapGrid | None
    world: WorldModel
    findings: list[Finding] = field(default_factory=list)
    files: dict[str, str] = field(default_factory=dict)


def load_map(
    world: WorldModel, written: Any, source: str | None, limits: Limits, kept: Mapping[str, str] | None = None
) -> LoadedMap:
    """Make the occupancy grid of a world. Problems are listed in ``findings``; none raises an exception.

    Args:
        world: The validated section.
        written: ``obstacle_map`` as written in the scenario.
        source: Path of the scenario file.
        limits: Upper bounds on maps, and the folder that must contain their files.
        kept: Files to read instead, by the name in the scenario.
    """
    options: Any = world.obstacle_map
    name = getattr(options, "name", None)
    if options is None or (name is not None and not _is_simulated(name)):
        return LoadedMap(None, world)
    site = _site(world, source, limits, kept or {})
    try:
        made = _make(options, site)
        world = _with_map_extent(world, made)
        origin = (float(world.offset[0]), float(world.offset[1]))
        grid = map_grid(made, world.width, world.height, origin, world.mdownsample)
    except MapProblem as problem:
        key = problem.key if problem.key is not None and not isinstance(written, str) else None
        path = _PATH if key is None or hasattr(options, "__array__") else (*_PATH, key)
        diagnostic = error(
            problem.code, path, problem.message, given=problem.given, allowed=problem.allowed, fix=problem.fix
        )
        return LoadedMap(None, world, [diagnostic])
    return LoadedMap(grid, world, [*_notes(site, written), *_check_occupancy(grid, world)], site.files)


def _is_simulated(name: str) -> bool:
    feature = MAPS.get(name)
    return feature is not None and feature.function is not None


def _site(world: WorldModel, source: str | None, limits: Limits, kept: Mapping[str, str]) -> MapSite:
    given = world.model_fields_set
    scenario = [FilePath(source).resolve().parent] if source is not None else []
    return MapSite(
        width=world.width if "width" in given else None,
        height=world.height if "height" in given else None,
        origin=(float(world.offset[0]), float(world.offset[1])) if "offset" in given else None,
        folders=_folders(scenario, limits.root),
        bundled=bundled_map,
        bundled_names=bundled_names,
        refuse=_refusal(limits.root),
        max_cells=limits.cells,
        max_bytes=limits.map_bytes,
        kept=kept,
        says_places=limits.root is None,
    )


def _folders(scenario: Sequence[FilePath], root: str | None) -> list[FilePath]:
    """Folders searched for map files: with a workspace only it and the scenario's, else as IR-SIM searches them."""
    if root is not None:
        return [FilePath(root), *scenario]
    script = [FilePath(os.path.abspath(sys.argv[0])).parent] if sys.argv and sys.argv[0] else []
    return [FilePath(), *scenario, FilePath(sys.path[0] or "."), *script]


def _refusal(root: str | None) -> Any:
    """The function that says why a file name is not allowed."""

    def refuse(name: str, folders: Sequence[FilePath]) -> str | None:
        return None if root is None else why_outside(name, FilePath(root), folders)

    return refuse


def _make(options: Any, site: MapSite) -> Raster | Noise:
    if hasattr(options, "__array__"):
        return _of_array(options, site)
    feature = MAPS.get(options.name)
    assert feature is not None
    assert feature.function is not None
    if not getattr(options, "sets_extent", False):
        site.width = site.width if site.width is not None else WorldModel.model_fields["width"].default
        site.height = site.height if site.height is not None else WorldModel.model_fields["height"].default
    made: Raster | Noise = feature.function(options, site)
    return made


def _of_array(array: Any, site: MapSite) -> Raster:
    import numpy as np

    values = np.asarray(array)
    numbers = values.dtype == np.bool_ or np.issubdtype(values.dtype, np.number)
    if values.ndim != 2 or not values.size or not numbers or np.iscomplexobj(values):
        raise MapProblem(
            "map-values",
            f"an occupancy grid must be an (nx, ny) array of numbers from 0 to 100, got shape {values.shape}",
            key=None,
            fix="i counts along +x, j along +y; values above 50 are occupied",
        )
    site.check_cells(values.shape[0], values.shape[1], None)
    return Raster(values.astype(np.float64))


def _with_map_extent(world: WorldModel, made: Raster | Noise) -> WorldModel:
    """The world with the extent that the map prescribes, for the keys that the scenario does not give."""
    if isinstance(made, Noise) or made.width is None:
        return world
    assert made.origin is not None
    given, changes = world.model_fields_set, dict[str, Any]()
    for key, value in (("width", made.width), ("height", made.height), ("offset", list(made.origin))):
        if key not in given:
            changes[key] = value
    return world.model_copy(update=changes) if changes else world


def _notes(site: MapSite, written: Any) -> list[Finding]:
    path = _PATH if isinstance(written, str) else (*_PATH, "path")
    return [(warning if code in _WARNED else hint)(code, path, message) for code, message in site.notes]


def _check_occupancy(grid: MapGrid, world: WorldModel) -> list[Finding]:
    if grid.cells is None:
        return []
    total = grid.size[0] * grid.size[1]
    if grid.cells.closed_count == 0:
        return [
            warning(
                "map-empty",
                _PATH,
                f"none of the {total:,} cells is occupied",
                fix="black is occupied and white is free",
            )
        ]
    if grid.cells.closed_count == total and grid.cells.count < total:
        what = f"none of the {total:,} cells is known to be free: planners find no way"
        return [warning("map-full", _PATH, what, fix="unknown: free")]
    if grid.cells.count == total:
        return [
            warning(
                "map-full",
                _PATH,
                f"{'the only cell is' if total == 1 else f'all {total:,} cells are'} occupied: nothing can move",
                fix=f"use a smaller 'mdownsample' (now {world.mdownsample})"
                if (world.mdownsample or 1) > 1
                else "black is occupied and white is free: invert the picture",
            )
        ]
    return []
