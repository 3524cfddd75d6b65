"""``perlin``: procedural noise."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.maps._site import MapSite, Noise, Raster, cells_along
from irsim.components.options import MapOptions
from irsim.options.registry import MAPS
from irsim.options.units import Fraction, Integer, Meters, Number, Seed

if TYPE_CHECKING:
    from irsim.common.arrays import Floats


class PerlinMap(MapOptions):
    """Cave-like walls from gradient noise."""

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "perlin", "resolution": 0.2, "fill": 0.3, "seed": 7}]
    }

    name: Literal["perlin"] = "perlin"
    resolution: Annotated[Meters, Field(gt=0)]
    """Cell size."""
    complexity: Annotated[Number, Field(gt=0, json_schema_extra={"x-unit": "1/cell"})] = 0.142857
    """Frequency of the noise: a larger one makes smaller free areas."""
    fill: Fraction = 0.38
    """Share of occupied cells."""
    fractal: Annotated[Integer, Field(ge=1, le=32)] = 1
    """Number of octaves: each adds finer detail."""
    attenuation: Annotated[Number, Field(gt=0)] = 0.5
    """Amplitude of octave k, counted from 0, is this divided by k + 1."""
    seed: Seed | None = None
    """Seed of the noise, for the same map every time; null draws a new map for every scene from the scenario's seed."""


def cells_of(site: MapSite, resolution: float) -> tuple[int, int]:
    """Number of cells of about this size along x and y of the world, at least one.

    Raises:
        MapProblem: The map would have too many cells.
    """
    width, height = site.width or 0.0, site.height or 0.0
    nx, ny = cells_along(width, resolution), cells_along(height, resolution)
    site.check_cells(nx, ny, "resolution")
    return nx, ny


def noise_values(
    columns: int, rows: int, complexity: float, fill: float, fractal: int, attenuation: float, seed: int | None
) -> Floats:
    """Occupancies of a noise map: (columns, rows) array, 100 where occupied, else 0.

    Args:
        columns: Cells along x.
        rows: Cells along y.
        complexity: Frequency of the first octave [1/cell].
        fill: Share of occupied cells.
        fractal: Octaves.
        attenuation: Amplitude of octave k, times k + 1.
        seed: Seed of the permutation behind the noise; None takes fresh entropy.
    """
    import numpy as np

    permutation = np.random.default_rng(seed).permutation(256)
    occupied = core.perlin_cells(permutation.tolist(), columns, rows, complexity, fill, fractal, attenuation)
    return occupied.astype(np.float64) * 100.0


@MAPS.register(PerlinMap)
def perlin(options: PerlinMap, site: MapSite) -> Raster | Noise:
    """Fixed cells if a seed is given, else noise that the core draws for each scene."""
    nx, ny = cells_of(site, options.resolution)
    if options.seed is None:
        return Noise((nx, ny), options.complexity, options.fill, options.fractal, options.attenuation)
    return Raster(
        noise_values(nx, ny, options.complexity, options.fill, options.fractal, options.attenuation, options.seed)
    )
