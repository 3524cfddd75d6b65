"""Layers of a figure that are images over the world: maps, and the fog."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.image import AxesImage

from irsim.components.maps._site import HALF, UNKNOWN_AS
from irsim.graphics.figure.canvas import rgba
from irsim.graphics.scene.scene import Fog, GridImage

__all__ = ["FogLayer", "GridLayer"]

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
    """The fog as an image over the world, updated only when more cells have been explored.

    Attributes:
        artist: The image.
    """

    def __init__(self, ax: Axes, zorder: float) -> None:
        self.artist = AxesImage(ax, interpolation="nearest", origin="lower", zorder=zorder)
        self.artist.set_clip_path(ax.patch)
        ax.add_image(self.artist)
        self._shown: Any = None

    def show(self, fog: Fog) -> None:
        """Show the fog."""
        if self._shown is not None and np.array_equal(self._shown, fog.explored):
            return
        self._shown = fog.explored
        color = np.array([round(255 * level) for level in rgba(fog.color, fog.alpha)], dtype=np.uint8)
        pixels = np.tile(color, (*fog.explored.T.shape, 1))
        pixels[fog.explored.T, 3] = 0
        self.artist.set_data(pixels)
        self.artist.set_extent(fog.extent)
