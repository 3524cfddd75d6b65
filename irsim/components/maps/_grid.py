"""The map of a world: its cells for the core, its occupancies for scripts."""

from __future__ import annotations

import copyreg
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import irsim._core as core
from irsim.components.maps._site import HALF, UNKNOWN, UNKNOWN_AS, Noise, Raster

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from irsim.common.arrays import Floats

__all__ = ["MapCells", "MapGrid", "Walls", "map_grid", "merged", "shades", "with_unknown"]

_MAX_CELLS_ALONG = 2**31 - 1
"""Largest number of cells along one side of a map."""


@dataclass(frozen=True)
class MapCells:
    """Shape of the object that represents a map in the world.

    Attributes:
        grid: The map.
    """

    grid: MapGrid
    name: str = "map"

    @property
    def fixed(self) -> bool:
        """Whether the cells are the same in every scene."""
        return self.grid.cells is not None

    def parts(self) -> list[core.Part]:
        """Geometry for the core, world frame."""
        return [self.grid.part]

    def model_dump(self) -> dict[str, str]:
        """The shape as it is written in a scenario."""
        return {"name": self.name}


@dataclass(frozen=True)
class Walls:
    """Shape of the walls round the world.

    Attributes:
        bounds: xmin, ymin, xmax, ymax [m].
    """

    bounds: tuple[float, float, float, float]
    name: str = "walls"
    fixed: bool = True

    def parts(self) -> list[core.Part]:
        """Geometry for the core, world frame."""
        x0, y0, x1, y1 = self.bounds
        return [core.Room(vertices=[[x0, y0], [x0, y1], [x1, y1], [x1, y0]])]

    def model_dump(self) -> dict[str, str]:
        """The shape as it is written in a scenario."""
        return {"name": self.name}


@dataclass(frozen=True)
class MapGrid:
    """An occupancy grid over a rectangle of the world.

    Attributes:
        size: Cells along x and y.
        cell: Extent of a cell along x and y [m].
        origin: Lower left corner, world frame [m].
        part: Shape for the core: fixed cells, or noise that is drawn for each scene.
        raster: The occupancies; None if they are drawn for each scene.
        cells: The occupied cells; None if they are drawn for each scene.
    """

    size: tuple[int, int]
    cell: tuple[float, float]
    origin: tuple[float, float]
    part: core.Part
    raster: Raster | None
    cells: core.OccupancyGrid | None

    @property
    def occupied(self) -> int:
        """Number of occupied cells; -1 if it differs from scene to scene."""
        return self.cells.count if self.cells is not None else -1

    @property
    def unknown(self) -> int:
        """Number of cells that planners avoid although they are not occupied, as the map does not know them."""
        return 0 if self.cells is None else self.cells.closed_count - self.cells.count

    def values(self) -> Floats:
        """(nx, ny) occupancies, 0 to 100, -1 where unknown.

        Raises:
            ValueError: They are drawn for each scene.
        """
        if self.raster is None:
            raise ValueError("this map is drawn for each scene, so it has no fixed values")
        return self.raster.values()


def map_grid(
    source: Raster | Noise, width: float, height: float, origin: tuple[float, float], downsample: int = 1
) -> MapGrid:
    """Lay a raster or noise over a rectangle.

    Args:
        source: Result of a map generator.
        width: Width of the rectangle [m].
        height: Height of the rectangle [m].
        origin: Lower left corner of the rectangle, world frame [m].
        downsample: Merge blocks of N x N cells.
    """
    downsample = min(downsample, _MAX_CELLS_ALONG)  # this leaves one cell of any map
    if isinstance(source, Noise):
        nx, ny = (-(-n // downsample) for n in source.size)
        cell = (width / nx, height / ny)
        part: core.Part = core.PerlinCells(
            size=source.size,
            every=downsample,
            origin=origin,
            cell_size=cell,
            complexity=source.complexity,
            fill=source.fill,
            fractal=source.fractal,
            attenuation=source.attenuation,
        )
        return MapGrid((nx, ny), cell, origin, part, None, None)
    raster = source
    if downsample > 1:
        raster = Raster(merged(source.values(), downsample))
    nx, ny = raster.levels.shape
    cell = (width / nx, height / ny)
    cells = core.OccupancyGrid(raster.occupied(), origin, cell, raster.unknown())
    return MapGrid((nx, ny), cell, origin, core.GridCells(grid=cells), raster, cells)


def merged(values: Floats, side: int) -> Floats:
    """Occupancies of blocks of cells, each with the largest of its cells, so that no wall is lost.

    A block without occupied cells is unknown if one of its cells is.

    Args:
        values: (nx, ny) occupancies, negative where unknown.
        side: Cells along a side of a block; those at the upper ends have the cells that are left.
    """
    import numpy as np

    least, most = values, values
    for axis in (0, 1):
        first = np.arange(0, values.shape[axis], side)
        most, least = np.maximum.reduceat(most, first, axis=axis), np.minimum.reduceat(least, first, axis=axis)
    return with_unknown(most, least)


def with_unknown(most: Floats, least: Floats) -> Floats:
    """Occupancies of blocks of cells: occupied if one of the cells is, else unknown if one is, else the largest.

    Args:
        most: Largest occupancy of the cells of each block, negative where unknown.
        least: Smallest one.
    """
    import numpy as np

    return np.where((most <= HALF) & (least < 0), UNKNOWN, most) if (least < 0).any() else most


def shades(values: Any) -> NDArray[np.uint8]:
    """(nx, ny) occupancies, 0 to 100, by which pictures show a map: unknown cells are grey.

    Args:
        values: (nx, ny) occupancies, negative where unknown.
    """
    import numpy as np

    return np.clip(np.where(np.asarray(values) < 0, UNKNOWN_AS["free"], values), 0, 100).astype(np.uint8)


def _reduce_grid(grid: core.OccupancyGrid) -> tuple[Any, ...]:
    return core.OccupancyGrid, (grid.occupied, grid.origin, grid.cell, grid.unknown)


def _reduce_part(part: Any) -> tuple[Any, ...]:
    return _make_part, (type(part), {name: getattr(part, name) for name in type(part).fields})


def _make_part(kind: Any, fields: dict[str, Any]) -> Any:
    return kind(**fields)


copyreg.pickle(core.OccupancyGrid, _reduce_grid)
for _kind in (core.GridCells, core.PerlinCells):
    copyreg.pickle(_kind, _reduce_part)
