"""Import of a map: find the kind of the file, read it, make the map of a level, write all files at once."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.entries import entries_of
from irsim.bridges.maps.occupancy import eroded, occupancy_of
from irsim.bridges.maps.shapes import occupancy_of_outlines
from irsim.bridges.maps.sidecar import MapSidecar, scene_transform
from irsim.bridges.maps.source import (
    ImportLimits,
    ImportOptions,
    Kind,
    Occupancy,
    Outlines,
    SceneTriangles,
    find_kind,
    known_free,
    unusable,
)
from irsim.bridges.maps.writing import Trip, files_of, suggest_trip, write_all_or_none
from irsim.common.arrays import Floats
from irsim.common.extras import require
from irsim.common.files import TargetError, check_suffix
from irsim.common.hashing import file_digest
from irsim.common.text import clean
from irsim.components.maps._site import HALF, UNKNOWN_AS
from irsim.diagnostics.diagnostic import format_path
from irsim.diagnostics.errors import ArgumentError
from irsim.results.records import MapImportResult, MapLevel, MapTrip
from irsim.scenario.file_kind import explained
from irsim.scenario.locate import why_outside
from irsim.scenario.yaml.document import Document

__all__ = ["import_map", "list_levels", "read_occupancy"]

_MAX_COMPONENTS = 20


def import_map(
    file: str | Path,
    out: str | Path,
    *,
    ros_map: str | Path | None = None,
    robot: bool = False,
    obstacles: bool = False,
    overwrite: bool = False,
    limits: ImportLimits | None = None,
    **options: Any,
) -> MapImportResult:
    """Make a scenario of a map, a mesh, a navigation mesh, a USD stage or a road network.

    Beside the scenario ``x.yaml`` are written its picture ``x.png`` and the sidecar ``x.bridge.json``, which says where
    the map is in the world of the file: see :mod:`irsim.bridges.maps.sidecar`.

    Args:
        file: The file; its suffix and its first bytes say what it is.
        out: Scenario to write.
        ros_map: YAML file of a map for the ROS map server to write as well; its picture is written beside it.
        robot: Whether the scenario gets a robot that drives from one end of the map to the other.
        obstacles: Whether the scenario gets obstacles with the exact outlines instead of a picture; only for files
            that have outlines, such as plans, footprints and worlds of Gazebo.
        overwrite: Whether to replace existing files.
        limits: How much an import may cost, and the folder that all files must lie in.
        **options: Fields of :class:`~irsim.bridges.maps.source.ImportOptions`.

    Returns:
        The files, the size of the map, its levels, and a start and a goal in it.

    Raises:
        BridgeError: The file cannot be used; nothing was written.
        ArgumentError: An option has a wrong value.
        ExtraError: A library is missing.
        TargetError: A file exists already.
    """
    chosen, bounds = _options(options), limits or ImportLimits()
    target, ros_target = _target(out, "out", bounds), None
    if ros_map is not None:
        ros_target = _target(ros_map, "ros_map", bounds)
    kind, result, source = read_occupancy(file, chosen, bounds)
    unknown = chosen.unknown or kind.unknown
    values, filled = _cells(result, chosen, unknown)
    entries = _entries(kind, result, chosen) if obstacles else None
    trip = suggest_trip(result, values)
    if robot and trip is None:
        raise BridgeError(
            "bridge-file", "the map has no room for a robot", "leave out the robot, or try less --inflate"
        )
    sidecar = MapSidecar(
        scene_transform(result.frame, result.height, result.meters_per_unit, result.turn),
        result.frame,
        result.height,
        result.grid.resolution,
        (result.grid.x, result.grid.y),
        (result.grid.nx, result.grid.ny),
        source,
        {
            "headroom": chosen.headroom if result.headroom is None else result.headroom,
            "climb": chosen.climb if result.climb is None else result.climb,
            "slope": chosen.slope,
            "radius": max(chosen.radius, result.radius),
        },
        result.level,
        unknown,
    )
    about = f"Made from {clean(source['file'], 100)}" + (f", level {result.level}" if result.levels else "")
    placed = trip if robot else None
    contents = files_of(result, values, filled, target, sidecar, about, placed, ros_target, entries)
    _check_targets([path for path, _ in contents], [_confined(file, "file", bounds), *result.parts])
    write_all_or_none(contents, overwrite=overwrite)
    written = [str(path) for path, _ in contents]
    return _result(kind, result, values, filled, unknown, trip, written, 0 if entries is None else len(entries))


def list_levels(file: str | Path, *, limits: ImportLimits | None = None, **options: Any) -> MapImportResult:
    """The result that :func:`import_map` would have for a file, above all its levels; nothing is written.

    Args:
        file: The file.
        limits: How much it may cost.
        **options: Fields of :class:`~irsim.bridges.maps.source.ImportOptions`.

    Raises:
        BridgeError: The file cannot be used.
        ArgumentError: An option has a wrong value.
        ExtraError: A library is missing.
    """
    chosen = _options(options)
    kind, result, _ = read_occupancy(file, chosen, limits or ImportLimits())
    unknown = chosen.unknown or kind.unknown
    values, filled = _cells(result, chosen, unknown)
    return _result(kind, result, values, filled, unknown, suggest_trip(result, values), [])


def _entries(kind: Kind, result: Occupancy, options: ImportOptions) -> list[str]:
    """Obstacles of a scenario as lines of YAML; remarks on them follow the remarks on the map.

    Raises:
        ArgumentError: The file has no outlines, or an option is about cells.
    """
    if result.things is None:
        raise ArgumentError(f"{kind.title} has surfaces or cells, and no outlines", "leave out --obstacles")
    for name in ("radius", "seed_point"):
        if getattr(options, name) != ImportOptions.model_fields[name].default:
            option = name.replace("_", "-")
            raise ArgumentError(f"the option {name} changes cells, and no obstacles", f"leave out --{option}")
    entries, notes = entries_of(result.things)
    if (result.values < 0).any():
        notes.append("what is beside the free area is open ground, as it has no outline; without --obstacles it is not")
    result.notes += notes
    return entries


def _cells(result: Occupancy, options: ImportOptions, unknown: str) -> tuple[Floats, Floats]:
    """(nx, ny) occupancies after the radius is taken away, -1 where unknown; the same with unknown cells filled in."""
    values = eroded(result.values, options.radius / result.grid.resolution)
    return values, np.where(values < 0, UNKNOWN_AS[unknown], values)


def read_occupancy(
    file: str | Path, options: ImportOptions, limits: ImportLimits
) -> tuple[Kind, Occupancy, dict[str, Any]]:
    """Kind, map, and name, size and hash of a file.

    Raises:
        BridgeError: The file cannot be used.
        ExtraError: A library is missing.
    """
    path = _confined(file, "file", limits)
    kind = find_kind(path)
    _check_used(kind, options)
    size = path.stat().st_size
    if size > limits.bytes:
        raise unusable(path, f"it has {size:,} bytes, and at most {limits.bytes:,} are read", "give a smaller file")
    if kind.libraries:
        require(kind.extra, *kind.libraries)
    source = {"file": path.name, "kind": kind.name, "bytes": size, "sha256": file_digest(path)}
    try:
        read = kind.read(path, options, limits)
        if isinstance(read, SceneTriangles):
            result = occupancy_of(read, options, limits)
        else:
            result = occupancy_of_outlines(read, options, limits) if isinstance(read, Outlines) else read
    except MemoryError:
        raise unusable(path, "it does not fit into memory", "give a coarser --resolution, or a smaller file") from None
    return kind, result, source


def _target(name: str | Path, where: str, limits: ImportLimits) -> Path:
    """A file to write."""
    target = _confined(name, where, limits)
    check_suffix(target, (".yaml", ".yml"))
    return target


def _confined(name: str | Path, where: str, limits: ImportLimits) -> Path:
    """The file of a name, which must not lead out of the folder of the limits."""
    if "\0" in str(name):
        raise BridgeError(
            "bridge-file", f"'{clean(str(name), 200)}' cannot be the name of a file", "name a file", where=where
        )
    if limits.root is None:
        return Path(name)
    wrong = why_outside(str(name), Path(limits.root))
    if wrong is not None:
        fix = "give a file inside the workspace"
        raise BridgeError("path-outside-workspace", f"'{clean(str(name), 200)}' {wrong}", fix, where=where)
    return Path(limits.root) / name


def _options(given: dict[str, Any]) -> ImportOptions:
    try:
        chosen = ImportOptions(**given)
    except ValidationError as error:
        first = explained(error, Document(given), ImportOptions)[0]
        what = f"the option {format_path(first.path)} is wrong: {first.message}"
        raise ArgumentError(what, f"options of imports are {', '.join(ImportOptions.model_fields)}") from None
    if chosen.bounds is not None and not (chosen.bounds[0] < chosen.bounds[2] and chosen.bounds[1] < chosen.bounds[3]):
        shown = ", ".join(f"{value:g}" for value in chosen.bounds)
        fix = "give x, y of the lower left and the upper right corner"
        raise ArgumentError(f"the bounds {shown} hold nothing", fix)
    return chosen


def _check_targets(targets: list[Path], sources: list[Path]) -> None:
    """Nothing that the map is made from is overwritten."""
    for target in targets:
        if target.exists() and any(target.samefile(source) for source in sources):
            raise TargetError("file-exists", f"{target} is what the map is made from; name another file with -o")


def _check_used(kind: Kind, options: ImportOptions) -> None:
    """No option is given that says nothing about files of this kind, and the root is a folder."""
    for name in kind.unused if kind.layered else (*kind.unused, "layers"):
        if getattr(options, name) != ImportOptions.model_fields[name].default:
            what = f"the option {name} says nothing about {kind.title}"
            raise ArgumentError(what, f"leave out --{'layer' if name == 'layers' else name.replace('_', '-')}")
    if options.root is not None and not Path(options.root).is_dir():
        what = f"there is no folder '{clean(options.root, 200)}'"
        raise ArgumentError(what, "give with --root the folder that holds the files")


def _result(
    kind: Kind,
    occupancy: Occupancy,
    values: Floats,
    filled: Floats,
    unknown: str,
    trip: Trip | None,
    files: list[str],
    obstacles: int = 0,
) -> MapImportResult:
    free = known_free(values)
    return MapImportResult(
        kind=kind.name,
        files=files,
        columns=occupancy.grid.nx,
        rows=occupancy.grid.ny,
        resolution=occupancy.grid.resolution,
        origin=(occupancy.grid.x, occupancy.grid.y),
        free_area=round(float(free.sum()) * occupancy.grid.resolution**2, 4),
        occupied=int((filled > HALF).sum()),
        obstacles=obstacles,
        unknown=int((values < 0).sum()),
        unknown_as=unknown,
        level=occupancy.level,
        height=round(occupancy.height, 4),
        levels=[
            MapLevel(level=k, height=round(height, 4), area=round(area, 4), roof=roof)
            for k, (height, area, roof) in enumerate(occupancy.levels)
        ],
        components=[round(area, 4) for area in occupancy.regions[:_MAX_COMPONENTS]],
        kept=occupancy.kept,
        trip=None if trip is None else MapTrip(start=trip.start, goal=trip.goal, clearance=trip.clearance),
        notes=[*occupancy.notes, *_smaller_part(occupancy), *([] if free.any() else ["no cell is free"])],
    )


def _smaller_part(occupancy: Occupancy) -> list[str]:
    """A note if the part that is free is not the largest one, as the top of a table at the seed point."""
    if not occupancy.kept:
        return []
    area, largest = occupancy.regions[occupancy.kept], occupancy.regions[0]
    what = f"only what is connected to the seed point is free, {area:.1f} m²; the largest part has {largest:.1f} m²"
    return [f"{what} and is taken without --seed-point: tops and insides of furniture are parts, too"]
