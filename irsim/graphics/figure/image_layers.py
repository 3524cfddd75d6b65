"""Layers of a figure that are images over the world: maps, and the fog."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.image import AxesImage
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.components.maps._site import HALF, UNKNOWN_AS
from irsim.graphics.figure.canvas import Canvas, rgba
from irsim.graphics.scene.scene import Fog, GridImage

__all__ = ["FogImage", "FogLayer", "GridLayer"]

_ALWAYS_RESTING = 1_000_000
"""Number of resting scenes given for a map, which never changes."""


class GridLayer:
    """One map.

    Attributes:
        artist: The image that shows it.
        version: Number of changes of the content.
        resting_scenes: Number of consecutive scenes without a change; a map counts as resting from the beginning.
    """

    def __init__(self, ax: Axes, zorder: float) -> None:
        self.artist = AxesImage(ax, cmap="gray", norm=None, interpolation="antialiased", origin="lower")
        self.artist.set_clim(0, 255)
        self.artist.set_zorder(zorder)
        ax.add_image(self.artist)
        self.artist.set_clip_path(ax.patch)
        self.version, self.resting_scenes = 0, _ALWAYS_RESTING
        self._shown: GridImage | None = None

    def show(self, grid: GridImage | None) -> None:
        """Show a map, or nothing for None."""
        self.artist.set_visible(grid is not None)
        if grid is self._shown or grid is None:
            return
        self._shown = grid
        self.version += 1
        if grid.color is None:
            self.artist.set_data(255 - np.minimum(grid.levels, 100).T * np.float32(2.55))
        else:
            cells = np.zeros((*grid.levels.T.shape, 4))
            if grid.unknown is not None:
                cells[UNKNOWN_AS["free"] == grid.levels.T] = rgba(grid.unknown)
            cells[grid.levels.T > HALF] = rgba(grid.color)
            self.artist.set_data(cells)
            self.artist.set_interpolation("nearest")
        self.artist.set_extent(grid.extent)


class FogLayer:
    """The fog as an image over the world, updated only where more cells have been explored.

    Attributes:
        artist: The image.
        version: Number of changes of the content.
        resting_scenes: Number of consecutive scenes without a change.
        soft: Whether its edge is soft.
    """

    def __init__(self, ax: Axes, zorder: float) -> None:
        self.artist = FogImage(ax, interpolation="nearest", origin="lower", zorder=zorder)
        self.artist.set_clip_path(ax.patch)
        ax.add_image(self.artist)
        self.version = self.resting_scenes = 0
        self.soft = False
        self._shown: Any = None

    def show(self, fog: Fog) -> None:
        """Show the fog."""
        if self._shown is not None and np.array_equal(self._shown, fog.explored):
            self.resting_scenes += 1
            return
        self.version += 1
        self.resting_scenes = 0
        self._shown, self.soft = fog.explored, fog.soft > 0
        self.artist.set_fog(fog)


class FogImage(AxesImage):
    """Fog: painted with a soft edge on a pixel canvas; an image of its cells elsewhere, and where its edge is sharp."""

    _fog: Fog | None = None
    _sheet: _FogSheet | None = None

    def set_fog(self, fog: Fog) -> None:
        """Set the fog."""
        self._fog = fog
        pixels = np.tile(_levels(fog), (*fog.explored.T.shape, 1))
        pixels[fog.explored.T, 3] = 0
        self.set_data(pixels)
        self.set_extent(fog.extent)

    def draw(self, renderer: Any, *args: Any, **kwargs: Any) -> None:
        """Draw the fog."""
        if not self.get_visible():
            return
        on_pixels = isinstance(renderer, RendererAgg) and self.axes is not None
        if on_pixels and self.paint_on(Canvas(self.axes, renderer)):
            return
        super().draw(renderer, *args, **kwargs)

    def paint_on(self, canvas: Canvas) -> bool:
        """Paint the fog if its edge is soft; return whether that was done."""
        if self._fog is None or not self._fog.soft:
            return False
        if self._sheet is None or self._sheet.key != canvas.key:
            self._sheet = _FogSheet(canvas, self._fog)
        image = self._sheet.image(self._fog)
        canvas.painter.image(canvas.pixels, image, self._sheet.left, self._sheet.top)
        return True


class _FogSheet:
    """Pixels of the fog on one canvas."""

    def __init__(self, canvas: Canvas, fog: Fog) -> None:
        self.key = canvas.key
        x0, x1, y0, y1 = fog.extent
        (left, low), (right, high) = canvas.to_pixel(x0, y0), canvas.to_pixel(x1, y1)
        self.left, self.top = max(0, round(left)), max(0, round(canvas.height - high))
        across = np.arange(self.left, min(canvas.width, round(right))) + 0.5
        up = canvas.height - (np.arange(self.top, min(canvas.height, round(canvas.height - low))) + 0.5)
        columns, rows = fog.explored.shape
        self._columns = _shares((across - left) / (right - left) * columns, columns, fog.soft)
        self._rows = _shares((up - low) / (high - low) * rows, rows, fog.soft)
        self._image = np.tile(_levels(fog), (len(up), len(across), 1))
        self._drawn: NDArray[np.bool_] | None = None

    def image(self, fog: Fog) -> NDArray[np.uint8]:
        """The pixels; only those near cells that have changed are made again."""
        hidden = ~np.asarray(fog.explored, dtype=bool)
        changed = np.ones_like(hidden) if self._drawn is None else self._drawn != hidden
        self._drawn = hidden
        columns = _touched(self._columns, np.flatnonzero(changed.any(axis=1)))
        rows = _touched(self._rows, np.flatnonzero(changed.any(axis=0)))
        (i, i_next, right), (j, j_next, up) = ([part[s] for part in parts] for parts, s in
            ((self._columns, columns), (self._rows, rows)))  # fmt: skip
        part = hidden.astype(np.float32)
        part = part[:, j] * (1 - up) + part[:, j_next] * up
        part = part[i].T * (1 - right) + part[i_next].T * right
        self._image[rows, columns, 3] = part * _levels(fog)[3] + np.float32(0.5)
        return self._image


def _shares(places: Floats, cells: int, soft: float) -> tuple[Any, Any, Any]:
    """Cells below and above the edges of windows at places [cells], and the share of the window in the one above."""
    below, above = (np.floor(places + side * soft / 2) for side in (-1, 1))
    share = np.where(above > below, (places + soft / 2 - above) / soft, 0.0).astype(np.float32)
    low, high = (np.clip(edge, 0, cells - 1).astype(int) for edge in (below, above))
    return low, high, share


def _touched(shares: tuple[Any, Any, Any], cells: NDArray[np.int64]) -> slice:
    """The pixels whose windows reach the cells from the first to the last of some."""
    if not len(cells):
        return slice(0, 0)
    near = np.flatnonzero((shares[1] >= cells[0]) & (shares[0] <= cells[-1]))
    return slice(int(near[0]), int(near[-1]) + 1) if len(near) else slice(0, 0)


def _levels(fog: Fog) -> NDArray[np.uint8]:
    return np.array([round(255 * level) for level in rgba(fog.color, fog.alpha)], dtype=np.uint8)
