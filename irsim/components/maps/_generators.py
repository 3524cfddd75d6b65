"""Base class of map generators in user code; defining a named subclass makes it part of the language."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar, Literal, cast

import numpy as np
from pydantic import Field, create_model

from irsim.common.arrays import Floats
from irsim.components.maps._picture import flattened, image_raster, open_picture
from irsim.components.maps._site import MapProblem, MapSite, Raster, bundled_map, bundled_names
from irsim.components.maps.perlin import cells_of, noise_values
from irsim.components.options import MapOptions
from irsim.options.registry import MAPS
from irsim.options.units import Meters

__all__ = [
    "GridMapGenerator",
    "ImageGridGenerator",
    "PerlinGridGenerator",
    "build_grid_from_generator",
    "resolve_obstacle_map",
]


class GridMapGenerator(ABC):
    """Makes an occupancy grid: derive, name it, list its parameters, implement ``_build_grid``.

    From then on ``obstacle_map: {name: <its name>, resolution: ...}`` uses the subclass. It is constructed
    with ``width`` and ``height`` in cells and the parameters that the scenario gives.

    Attributes:
        name: Name in scenarios.
        yaml_param_names: Keys of the mapping that are passed to the constructor.
        registry: Every generator by its name.
    """

    name: ClassVar[str] = ""
    yaml_param_names: ClassVar[tuple[str, ...]] = ()
    registry: ClassVar[dict[str, type[GridMapGenerator]]] = {}

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        name = cls.__dict__.get("name", "")
        if not name:
            return
        GridMapGenerator.registry[name] = cls
        if cls.__module__ != __name__:
            _register(name, cls)

    def __init__(self, **kwargs: Any) -> None:
        self._grid: Floats | None = None

    @abstractmethod
    def _build_grid(self) -> Any:
        """(nx, ny) occupancies, 0 to 100; i counts along +x, j along +y, above 50 is occupied."""

    @property
    def grid(self) -> Floats:
        """(nx, ny) occupancies, made when first asked for."""
        made = getattr(self, "_grid", None)
        return made if made is not None else self.generate()._grid_made()

    def generate(self) -> GridMapGenerator:
        """Make the grid, again if it exists already, and return the generator."""
        self._grid = np.asarray(self._build_grid(), dtype=np.float64)
        return self

    def _grid_made(self) -> Floats:
        assert self._grid is not None
        return self._grid

    def preview(self) -> None:
        """Show the grid in a window."""
        from matplotlib import pyplot

        pyplot.imshow(self.grid.T, cmap="gray_r", origin="lower", vmin=0, vmax=100)
        pyplot.title(self.name)
        pyplot.show()

    def save_as_image(self, path: str | Path, invert: bool = True) -> None:
        """Write the grid as a picture whose rows are the first axis of the grid.

        Args:
            path: File to write.
            invert: Whether occupied cells are black.
        """
        from PIL import Image

        levels = np.clip(self.grid, 0, 100) * 2.55
        grey = np.round(255 - levels if invert else levels).astype(np.uint8)
        Image.fromarray(grey).convert("RGBA").save(path)


class ImageGridGenerator(GridMapGenerator):
    """A picture file: black is occupied."""

    name = "image"
    yaml_param_names = ("path",)

    def __init__(self, path: str, **kwargs: Any) -> None:
        super().__init__()
        self.path = path

    def _build_grid(self) -> Floats:
        return _picture(self.path)


class PerlinGridGenerator(GridMapGenerator):
    """Gradient noise; see :class:`irsim.components.maps.perlin.PerlinMap`. ``width`` and ``height`` are cells."""

    name = "perlin"
    yaml_param_names = ("complexity", "fill", "fractal", "attenuation", "seed")

    def __init__(
        self,
        width: int,
        height: int,
        complexity: float = 0.142857,
        fill: float = 0.38,
        fractal: int = 1,
        attenuation: float = 0.5,
        seed: int | None = None,
    ) -> None:
        super().__init__()
        if fractal < 1:
            raise ValueError(f"fractal, the number of octaves, must be at least 1, got {fractal}")
        if attenuation <= 0:
            raise ValueError(f"attenuation must be positive, got {attenuation}")
        self.width, self.height = width, height
        self.complexity, self.fill, self.fractal = complexity, fill, fractal
        self.attenuation, self.seed = attenuation, seed

    def _build_grid(self) -> Floats:
        return noise_values(
            self.width, self.height, self.complexity, self.fill, self.fractal, self.attenuation, self.seed
        )


def resolve_obstacle_map(
    obstacle_map: Any = None, world_width: float | None = None, world_height: float | None = None
) -> Floats | None:
    """The occupancy grid that a value of ``obstacle_map`` means.

    Args:
        obstacle_map: None, an array (used as it is), a picture file name, or a mapping with the name of a generator.
        world_width: Extent of the world in x [m]; not needed for pictures.
        world_height: Extent of the world in y [m].

    Returns:
        (nx, ny) occupancies, 0 to 100; None for None.

    Raises:
        TypeError: The value is none of these.
        ValueError: The name is unknown, or a key is missing.
        FileNotFoundError: The picture does not exist.
    """
    if obstacle_map is None:
        return None
    if isinstance(obstacle_map, np.ndarray):
        return obstacle_map.astype(np.float64)
    if isinstance(obstacle_map, (str, Path)):
        obstacle_map = {"name": "image", "path": str(obstacle_map)}
    if not isinstance(obstacle_map, Mapping) or "name" not in obstacle_map:
        raise TypeError("a map must be None, an array, a file name, or a mapping with the 'name' of a generator")
    if obstacle_map["name"] == "image":
        if "path" not in obstacle_map:
            raise ValueError("an image map needs a 'path'")
        return _picture(str(obstacle_map["path"]))
    return build_grid_from_generator(dict(obstacle_map), world_width or 0.0, world_height or 0.0)


def build_grid_from_generator(spec: dict[str, Any], world_width: float, world_height: float) -> Floats:
    """The grid of a generator that fills a world.

    Args:
        spec: Mapping with ``name``, ``resolution`` (cell size [m]) and parameters; other keys are ignored.
        world_width: Extent of the world in x [m].
        world_height: Extent of the world in y [m].

    Raises:
        ValueError: The name is unknown, or the resolution is missing.
    """
    name = spec.get("name")
    generator = GridMapGenerator.registry.get(str(name))
    if generator is None:
        raise ValueError(f"unknown map generator {name!r}; known: {', '.join(GridMapGenerator.registry)}")
    if "resolution" not in spec:
        raise ValueError("a map generator needs a 'resolution': cell size in metres")
    resolution = float(spec["resolution"])
    size = max(1, round(world_width / resolution)), max(1, round(world_height / resolution))
    return _made_by(generator, size, spec)


def _made_by(generator: type[GridMapGenerator], size: tuple[int, int], spec: Mapping[str, Any]) -> Floats:
    parameters = {key: spec[key] for key in generator.yaml_param_names if key in spec}
    make = cast("Any", generator)
    grid: Floats = make(width=size[0], height=size[1], **parameters).generate().grid
    return grid


def _picture(path: str) -> Floats:
    site = MapSite(folders=[Path()], bundled=bundled_map, bundled_names=bundled_names)
    try:
        file = site.find(path)
        pixels, is_png = open_picture(file, path, site)
        return np.ascontiguousarray(image_raster(flattened(pixels, path, site), is_png).values())
    except MapProblem as problem:
        kind = FileNotFoundError if problem.code == "map-not-found" else ValueError
        raise kind(problem.message) from None


def _register(name: str, generator: type[GridMapGenerator]) -> None:
    """Register a generator of user code as part of the language."""
    keys: Any = {key: (Any, None) for key in generator.yaml_param_names if key not in ("name", "resolution")}
    make: Any = create_model
    options = make(
        f"{generator.__name__}Options",
        __base__=MapOptions,
        __module__=generator.__module__,
        __doc__=generator.__doc__,
        name=(Literal[name], name),
        resolution=(Meters, Field(gt=0, description="Cell size.")),
        **keys,
    )

    def run(chosen: Any, site: MapSite) -> Raster:
        size = cells_of(site, chosen.resolution)
        try:
            values = np.asarray(_made_by(generator, size, chosen.model_dump(exclude_unset=True)), dtype=np.float64)
        except Exception as error:
            raise MapProblem(
                "map-generator", f"'{name}' ({generator.__name__}) raised {type(error).__name__}: {error}", key="name"
            ) from error
        if values.ndim != 2 or not values.size:
            raise MapProblem(
                "map-generator",
                f"'{name}' ({generator.__name__}) must return an (nx, ny) array, got shape {values.shape}",
                key="name",
            )
        return Raster(values)

    MAPS.replace(options, name, run)
