"""Write maps of scenarios for the ROS map server."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.writing import picture_bytes, write_all_or_none
from irsim.common.arrays import Floats
from irsim.common.files import check_suffix
from irsim.components.maps._rosmap import MODES, RosMeta, pixels_of
from irsim.components.maps._site import HALF
from irsim.objects.describe import grid_values
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.simulation.random_streams import fresh_seed
from irsim.simulation.simulation import Simulation

__all__ = ["MODES", "MapFileError", "MapFiles", "export_map"]

_MAX_ASPECT_ERROR = 1e-6
"""Share by which the sides of a cell may differ for it to count as square."""


class MapFileError(BridgeError):
    """A map cannot be read or written."""


@dataclass(frozen=True)
class MapFiles:
    """The files of a converted map, and its size.

    Attributes:
        files: Paths of the files.
        columns, rows: Number of cells along x and y.
        resolution: Side of a cell [m].
        origin: Lower left corner [m].
        occupied: Number of occupied cells.
    """

    files: list[str]
    columns: int
    rows: int
    resolution: float
    origin: tuple[float, float]
    occupied: int

    def as_dict(self) -> dict[str, Any]:
        """The result as JSON types."""
        return dict(self.__dict__)


def export_map(
    scenario: ResolvedScenario,
    out: str | Path,
    *,
    mode: str = "trinary",
    image: str = "pgm",
    seed: int | None = None,
    overwrite: bool = False,
) -> MapFiles:
    """Convert the map of a scenario to files for the ROS map server.

    Args:
        scenario: A scenario with a map.
        out: YAML file to write; the picture is written beside it.
        mode: Encoding of the occupancy: ``trinary``, ``scale`` or ``raw``.
        image: Format of the picture: ``pgm`` or ``png``.
        seed: Seed of a random map; default: the scenario's own.
        overwrite: Replace existing files.

    Raises:
        MapFileError: The scenario has no map, or the picture cannot hold its unknown cells.
        TargetError: A file exists already.
    """
    target = Path(out)
    check_suffix(target, (".yaml", ".yml"))
    if scenario.grid is None:
        raise MapFileError("no-map", "this scenario has no 'world.obstacle_map' to export")
    if scenario.grid.raster is None:
        chosen = seed if seed is not None else scenario.world.seed
        values = grid_values(Simulation(scenario, [fresh_seed() if chosen is None else chosen]))
        assert values is not None
    else:
        values = scenario.grid.values()
    values, side = _with_square_cells(values, scenario.grid.cell)
    picture = target.with_suffix(f".{image}")
    if image == "pgm" and mode == "scale" and (values < 0).any():
        what = "mode scale tells unknown cells by opacity, which pictures of the format pgm do not have"
        raise MapFileError("bad-argument", what, "write --image png, or --mode trinary or raw")
    meta = RosMeta(picture.name, side, (*scenario.grid.origin, 0.0), mode=mode)
    content = picture_bytes(pixels_of(values, meta), "PNG" if picture.suffix == ".png" else "PPM")
    write_all_or_none([(target, meta.as_yaml().encode()), (picture, content)], overwrite=overwrite)
    nx, ny = values.shape
    occupied = int((values > HALF).sum())
    return MapFiles([str(target), str(picture)], nx, ny, side, scenario.grid.origin, occupied)


def _with_square_cells(values: Floats, cell: tuple[float, float]) -> tuple[Floats, float]:
    """Resample a grid to square cells, which the map server needs, as small as the shorter side of the cells."""
    side = min(cell)
    if max(cell) <= side * (1 + _MAX_ASPECT_ERROR):
        return values, side
    size = [max(1, round(n * c / side)) for n, c in zip(values.shape, cell, strict=True)]
    i, j = (
        np.minimum(((np.arange(n) + 0.5) * side / c).astype(np.int64), have - 1)
        for n, c, have in zip(size, cell, values.shape, strict=True)
    )
    return values[np.ix_(i, j)], side
