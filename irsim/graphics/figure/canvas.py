"""The canvas of a frame, with its view of the world, and outlines of marks."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.colors import to_rgba
from matplotlib.path import Path
from numpy.typing import NDArray

from irsim import _core as core
from irsim.common.arrays import Floats
from irsim.graphics.scene.glyphs import GLOW
from irsim.graphics.scene.scene import Circle, Geometry, Line, Mark, Region, Sector, Segments, Spots, Stroke
from irsim.graphics.scene.style import Color

__all__ = ["Box", "Canvas", "around", "geometry_path", "rgba", "without_glow"]

Box = tuple[int, int, int, int]
"""Left, top, right and bottom of a part of a canvas [px], top row first."""
POINTS_PER_INCH = 72.0


def around(boxes: Sequence[Box]) -> Box | None:
    """Return the box around others; None without others."""
    if not boxes:
        return None
    lefts, tops, rights, bottoms = zip(*boxes, strict=True)
    return min(lefts), min(tops), max(rights), max(bottoms)


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
        self._rows = (xx, xy, x), (yx, yy, y)
        same = earlier is not None and (earlier.size, earlier.dpi) == (self.size, self.dpi)
        self._scratch: Any = earlier._scratch if earlier is not None and same else None

    def to_pixels(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Convert points (N, 2) of the world to pixels from the lower left corner."""
        return np.asarray(points @ self._matrix[:2, :2].T + self._matrix[:2, 2])

    def to_pixel(self, x: float, y: float) -> tuple[float, float]:
        """Convert a point of the world to pixels from the lower left corner."""
        (xx, xy, left), (yx, yy, low) = self._rows
        return xx * x + xy * y + left, yx * x + yy * y + low

    def new_renderer(self) -> Any:
        """Return a transparent canvas of the same size."""
        new: Any = RendererAgg
        return new(self.width, self.height, self.dpi)

    def scratch(self) -> Any:
        """Return a transparent canvas of the same size, which must be cleared after use."""
        if self._scratch is None:
            self._scratch = self.new_renderer()
        return self._scratch


_UNIT_CIRCLE = Path.unit_circle()
_KNOWN_COLORS = 2048
_GLOW_RINGS = 12
"""Number of polygons that stand for a glow in vector graphics."""


def rgba(color: Color, alpha: float = 1.0) -> tuple[float, float, float, float]:
    """Convert a colour to red, green, blue and opacity (0..1); ``alpha`` multiplies the colour's own opacity.

    Raises:
        ValueError: The colour is not valid.
    """
    given: Any = color
    return _known(color, alpha) if isinstance(color, str) and color[:1] == "#" else _faded(given, alpha)


def _faded(color: Any, alpha: float) -> tuple[float, float, float, float]:
    red, green, blue, opacity = to_rgba(color)
    return red, green, blue, opacity * float(alpha)


_known = lru_cache(maxsize=_KNOWN_COLORS)(_faded)


def geometry_path(geometry: Geometry) -> Path:
    """Return the outline of a mark as a Matplotlib path."""
    if isinstance(geometry, Circle):
        return _scale_and_move(_UNIT_CIRCLE, geometry)
    if isinstance(geometry, Spots):
        discs = [_scale_and_move(_UNIT_CIRCLE, Circle(x, y, geometry.radius)) for x, y in geometry.points.tolist()]
        return Path.make_compound_path(*discs)
    if isinstance(geometry, Segments):
        return Path.make_compound_path(*[Path(points) for points in geometry.points])
    if isinstance(geometry, Line):
        return Path(geometry.points)
    if isinstance(geometry, Sector):
        return _scale_and_move(Path.wedge(math.degrees(geometry.start), math.degrees(geometry.end)), geometry)
    if len(geometry.rings) == 1:
        return _ring(geometry.rings[0])
    return Path.make_compound_path(*[_ring(ring) for ring in geometry.rings])


def without_glow(mark: Mark) -> list[Mark]:
    """Return marks of even opacity that stand for one with a glow; any other mark as it is."""
    if mark.glow is None or not isinstance(mark.geometry, Region):
        return [mark]
    x, y, reach = mark.glow
    away = mark.geometry.rings[0] - (x, y)
    length = np.maximum(np.hypot(away[:, 0], away[:, 1]), 1e-12)[:, None]
    marks = []
    levels = [_glow_level((step - 0.5) / _GLOW_RINGS) for step in range(1, _GLOW_RINGS + 1)]
    for step, (level, next_level) in enumerate(itertools.pairwise([*levels, 0.0]), 1):
        ring = Region([np.array([x, y]) + away * np.minimum(1.0, reach * step / _GLOW_RINGS / length)])
        alpha = mark.alpha * (level - next_level)
        marks.append(Mark(mark.object, mark.part, ring, mark.fill, Stroke(None), alpha, mark.zorder))
    return marks


def _glow_level(away: float) -> float:
    """Opacity of a glow at a share of its reach, as the painter draws it."""
    return (1.0 - GLOW["fall"] * away) * min(1.0, (1.0 - away) / GLOW["soft"])


def _ring(points: Floats) -> Path:
    closed = np.concatenate([points, points[:1]])
    codes = np.full(len(closed), Path.LINETO, dtype=Path.code_type)
    codes[0], codes[-1] = Path.MOVETO, Path.CLOSEPOLY
    return Path(closed, codes)


def _scale_and_move(unit: Path, target: Circle | Sector) -> Path:
    """Scale and move a path of radius 1 about the origin to the radius and centre of ``target``."""
    return Path(np.asarray(unit.vertices) * target.radius + (target.x, target.y), unit.codes)
