"""``ros``: maps of the ROS map server, a YAML file with a picture."""

from __future__ import annotations

from pathlib import Path

from irsim.bridges.maps.grid import Grid
from irsim.bridges.maps.regions import keep_part
from irsim.bridges.maps.ros_server import MapFileError
from irsim.bridges.maps.source import NOT_FLAT, ImportLimits, ImportOptions, Kind, Occupancy, known_free
from irsim.components.maps._rosmap import find_picture, read_meta, ros_raster
from irsim.components.maps._site import UNKNOWN, MapProblem, MapSite
from irsim.scenario.locate import why_outside

__all__ = ["KIND"]

_FARTHEST = 1e9
"""Largest coordinate of a map [m]."""


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> Occupancy:
    """The map as it is.

    Raises:
        MapFileError: The map cannot be read.
    """

    def refuse(name: str, folders: object) -> str | None:
        return None if limits.root is None else why_outside(name, path.parent)

    site = MapSite(folders=[Path()] if limits.root is None else [], refuse=refuse, says_places=limits.root is None)
    try:
        raster = ros_raster(path, path.name, site, UNKNOWN)
        notes = [sentence for _, sentence in site.notes]
        picture = find_picture(read_meta(path, path.name).image, path, site)
    except MapProblem as problem:
        fix = "correct the key image of the file" if problem.code == "map-not-found" else problem.fix
        raise MapFileError(problem.code, problem.message, fix) from None
    assert raster.width is not None
    assert raster.origin is not None
    if not max(abs(raster.origin[0]), abs(raster.origin[1]), raster.width) <= _FARTHEST:
        what = f"the map is {raster.width:g} m wide and begins at ({raster.origin[0]:g}, {raster.origin[1]:g}) m"
        raise MapFileError("bridge-file", what, "correct the keys resolution and origin of the file")
    values = raster.values()
    grid = Grid(*raster.origin, raster.width / values.shape[0], *values.shape)
    result = Occupancy(values, grid, "ros", notes=notes, parts=[picture])
    if known_free(values).any():
        keep_part(result, options.seed_point)
    return result


KIND = Kind(
    name="ros",
    title="the YAML file of a map of the ROS map server",
    suffixes=(".yaml", ".yml"),
    accepts=lambda head: b"image" in head or b"resolution" in head,
    read=read,
    unused=("resolution", *NOT_FLAT, "bounds"),
    unknown="unknown",
)
