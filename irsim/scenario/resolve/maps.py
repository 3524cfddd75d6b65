"""The map a scenario asks for: found, read and laid over the world, or what stands in the way."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path as FilePath
from typing import Any

from irsim.components.maps._bundled import bundled_map, bundled_names
from irsim.components.maps._grid import MapGrid, map_grid
from irsim.components.maps._site import MapProblem, MapSite, Noise, Raster
from irsim.options.registry import MAPS
from irsim.scenario.limits import Limits
from irsim.scenario.messages.findings import Finding, error, hint, warning
from irsim.scenario.model.world import WorldModel
from irsim.scenario.path_confinement import why_outside

__all__ = ["LoadedMap", "load_map"]

_PATH = ("world", "obstacle_map")


@dataclass(frozen=True)
class LoadedMap:
    """What became of ``world.obstacle_map``.

    Attributes:
        grid: The map; None without one.
        world: The world, with the extent of a map that prescribes one.
        findings: What was wrong, and what is worth knowing.
        files: By the name in the scenario, the files that it was read from.
    """

    grid: MapGrid | None
    world: WorldModel
    findings: list[Finding] = field(default_factory=list)
    files: dict[str, str] = field(default_factory=dict)


def load_map(
    world: WorldModel, written: Any, source: str | None, limits: Limits, kept: Mapping[str, str] | None = None
) -> LoadedMap:
    """Make the occupancy grid of a world. Whatever is wrong ends up in ``findings``, never in an exception.

    Args:
        world: The validated section.
        written: ``obstacle_map`` as the scenario has it.
        source: Path of the scenario file.
        limits: Size of maps, and the folder to stay in.
        kept: Files that stand in for those of these names.
    """
    options: Any = world.obstacle_map
    name = getattr(options, "name", None)
    if options is None or (name is not None and not _simulated(name)):
        return LoadedMap(None, world)
    site = _site(world, source, limits, kept or {})
    try:
        made = _make(options, site)
        world = _fitted(world, made)
        origin = (float(world.offset[0]), float(world.offset[1]))
        grid = map_grid(made, world.width, world.height, origin, world.mdownsample)
    except MapProblem as problem:
        key = problem.key if problem.key is not None and not isinstance(written, str) else None
        path = _PATH if key is None or hasattr(options, "__array__") else (*_PATH, key)
        found = error(
            problem.code, path, problem.message, given=problem.given, allowed=problem.allowed, fix=problem.fix
        )
        return LoadedMap(None, world, [found])
    return LoadedMap(grid, world, [*_notes(site, written), *_share(grid, world)], site.found)


def _simulated(name: str) -> bool:
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
        refuse=_guard(limits.root),
        most_cells=limits.cells,
        most_bytes=limits.map_bytes,
        kept=kept,
    )


def _folders(scenario: Sequence[FilePath], root: str | None) -> list[FilePath]:
    """The current directory, beside the scenario, ``sys.path[0]``, beside the script; inside a workspace only that."""
    if root is not None:
        return [FilePath(root), *scenario]
    script = [FilePath(os.path.abspath(sys.argv[0])).parent] if sys.argv and sys.argv[0] else []
    return [FilePath(), *scenario, FilePath(sys.path[0] or "."), *script]


def _guard(root: str | None) -> Any:
    def refuse(name: str, folders: Sequence[FilePath]) -> str | None:
        return None if root is None else why_outside(name, FilePath(root), folders)

    return refuse


def _make(options: Any, site: MapSite) -> Raster | Noise:
    if hasattr(options, "__array__"):
        return _of_array(options, site)
    feature = MAPS.get(options.name)
    assert feature is not None
    assert feature.function is not None
    whole = site
    if not getattr(options, "sets_extent", False):
        whole.width = site.width if site.width is not None else WorldModel.model_fields["width"].default
        whole.height = site.height if site.height is not None else WorldModel.model_fields["height"].default
    made: Raster | Noise = feature.function(options, whole)
    return made


def _of_array(array: Any, site: MapSite) -> Raster:
    import numpy as np

    values = np.asarray(array)
    numbers = values.dtype == np.bool_ or np.issubdtype(values.dtype, np.number)
    if values.ndim != 2 or not values.size or not numbers or np.iscomplexobj(values):
        raise MapProblem(
            "map-values",
            f"an occupancy grid is an array of (nx, ny) numbers from 0 to 100, not one of shape {values.shape}",
            key=None,
            fix="i counts along +x, j along +y; values above 50 are occupied",
        )
    site.check_cells(values.shape[0], values.shape[1], None)
    return Raster(values.astype(np.float64))


def _fitted(world: WorldModel, made: Raster | Noise) -> WorldModel:
    """The world with the extent that the map prescribes where the scenario has none of its own."""
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
    return [hint(code, path, message) for code, message in site.notes]


def _share(grid: MapGrid, world: WorldModel) -> list[Finding]:
    if grid.cells is None:
        return []
    total = grid.size[0] * grid.size[1]
    if grid.cells.count == 0:
        return [
            warning(
                "map-empty",
                _PATH,
                f"none of the {total:,} cells is occupied",
                fix="black is occupied and white is free; 'mdownsample' may have dropped thin lines",
            )
        ]
    if grid.cells.count == total:
        return [
            warning(
                "map-full",
                _PATH,
                f"{'the only cell is' if total == 1 else f'all {total:,} cells are'} occupied: nothing can move",
                fix=f"a smaller 'mdownsample' ; now every {world.mdownsample}th row and column is kept"
                if (world.mdownsample or 1) > 1
                else "black is occupied and white is free: invert the picture",
            )
        ]
    return []
