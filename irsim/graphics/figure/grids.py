"""The grid layer: a map as one image under everything else."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.image import AxesImage

from irsim.graphics.scene.scene import GridImage

__all__ = ["GridLayer"]

_RESTING = 1_000_000  # a map never changes within a scene


class GridLayer:
    """One map.

    Attributes:
        artist: The image that shows it.
        version: Counts changes of content.
        rested: Scenes in a row without a change: a map rests from the beginning.
    """

    def __init__(self, ax: Axes, zorder: float) -> None:
        self.artist = AxesImage(ax, cmap="gray", norm=None, interpolation="antialiased", origin="lower")
        self.artist.set_clim(0, 255)
        self.artist.set_zorder(zorder)
        ax.add_image(self.artist)
        self.artist.set_clip_path(ax.patch)
        self.version, self.rested = 0, _RESTING
        self._shown: GridImage | None = None

    def show(self, grid: GridImage | None) -> None:
        """Draw this map; None draws nothing."""
        self.artist.set_visible(grid is not None)
        if grid is self._shown or grid is None:
            return
        self._shown = grid
        self.version += 1
        self.artist.set_data(255 - np.minimum(grid.levels, 100).T * np.float32(2.55))
        self.artist.set_extent(grid.extent)
