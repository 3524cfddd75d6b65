"""The grid layer: a map as one image below everything else."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.image import AxesImage

from irsim.graphics.scene.scene import GridImage

__all__ = ["GridLayer"]

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
        self.artist.set_data(255 - np.minimum(grid.levels, 100).T * np.float32(2.55))
        self.artist.set_extent(grid.extent)
