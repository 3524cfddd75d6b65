"""The canvas of a frame: its pixels, its view of the world, and what was painted into it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import RendererAgg
from numpy.typing import NDArray

from irsim import _core as core

__all__ = ["Box", "Canvas"]

Box = tuple[int, int, int, int]
"""Left, top, right and bottom of a part of a canvas [px], top row first."""
POINTS_PER_INCH = 72.0


class Canvas:
    """The canvas that layers draw for: its pixels, its resolution and its view of the world.

    Args:
        ax: Matplotlib axes in world coordinates.
        renderer: The Agg renderer of the canvas.
        earlier: The canvas of the last frame, whose memory may serve again.

    Attributes:
        renderer: The Agg renderer.
        pixels: (height, width, 4) pixels of the canvas.
        px_per_point: Pixels per point of line width.
        key: Differs between canvases on which the same track has other pixels.
        clip: The area of the axes, as Agg cuts marks [px].
        painter: Paints shapes in the coordinates of the axes into pictures of this size; remembers where.
        unknown: Whether something was drawn without the painter.
    """

    def __init__(self, ax: Any, renderer: Any, earlier: Canvas | None = None) -> None:
        self.renderer = renderer
        self.pixels: NDArray[np.uint8] = np.asarray(renderer.buffer_rgba())
        self.height, self.width = self.pixels.shape[:2]
        self.dpi = float(renderer.dpi)
        self.px_per_point = self.dpi / POINTS_PER_INCH
        self.unknown = False
        matrix = ax.transData.get_matrix()
        x0, y0, x1, y1 = map(float, ax.bbox.extents)
        self.size = self.width, self.height
        self.key = (self.size, self.dpi, matrix.tobytes(), x0, y0, x1, y1)
        left, right = max(0, math.floor(x0 + 0.5)), min(self.width, math.floor(x1 + 0.5))
        top, bottom = max(0, math.floor(self.height - y1 + 0.5)), min(self.height, math.floor(self.height - y0 + 0.5))
        self.clip: Box = (left, top, max(left, right), max(top, bottom))
        (xx, xy, x), (yx, yy, y), _ = matrix.tolist()
        self.painter = core.Painter(self.size, self.clip, (xx, xy, x, -yx, -yy, self.height - y))
        self._matrix = matrix
        same = earlier is not None and (earlier.size, earlier.dpi) == (self.size, self.dpi)
        self._scratch: Any = earlier._scratch if earlier is not None and same else None

    def to_pixels(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Convert points (N, 2) of the world to pixels from the lower left corner."""
        return np.asarray(points @ self._matrix[:2, :2].T + self._matrix[:2, 2])

    def new_renderer(self) -> Any:
        """Return a transparent canvas of the same size."""
        new: Any = RendererAgg
        return new(self.width, self.height, self.dpi)

    def scratch(self) -> Any:
        """Return a transparent canvas of the same size, which must be cleared after use."""
        if self._scratch is None:
            self._scratch = self.new_renderer()
        return self._scratch
