"""The canvas of a frame, and the brush that paints marks straight into its pixels, as Agg draws them."""

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
from irsim.graphics.figure.dashes import SOLID, outline
from irsim.graphics.scene.glyphs import GLOW
from irsim.graphics.scene.scene import Circle, Geometry, Line, Mark, Region, Sector, Segments, Spots, Stroke
from irsim.graphics.scene.style import Color

__all__ = ["Box", "Canvas", "geometry_path", "paint", "rgba", "without_glow"]

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
_TRANSPARENT = (0.0, 0.0, 0.0, 0.0)
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


def paint(
    canvas: Canvas,
    target: tuple[NDArray[np.uint8], Any],
    ax: Any,
    marks: Sequence[Mark],
    points_per_metre: float,
    ends: tuple[str, str],
) -> None:
    """Paint marks whose strokes are solid, or have few dashes.

    Args:
        canvas: The canvas, which tells the view and notes what was painted.
        target: Pixels to paint into, of the size of the canvas, and the Agg renderer that they belong to.
        ax: Axes in world coordinates, which cut the marks.
        marks: The marks.
        points_per_metre: Scale of the view, for line widths given in metres.
        ends: Styles of caps and joins of strokes.
    """
    pixels, renderer = target
    painter, per_point = canvas.painter, canvas.px_per_point
    per_metre = points_per_metre * per_point
    for mark in marks:
        stroke, fill, shape = mark.stroke, mark.fill, mark.geometry
        edge = _TRANSPARENT if stroke.color is None else rgba(stroke.color, mark.alpha)
        width = stroke.width * (per_metre if stroke.metric else per_point)
        face = _TRANSPARENT if fill is None else rgba(fill, mark.alpha)
        if stroke.style not in SOLID and (path := outline(mark)) is not None:
            if isinstance(shape, Region) and fill is not None:
                painter.polygon(pixels, shape.rings[0], face, _TRANSPARENT, 0.0, ends[1])
            pattern = [length * width for length in stroke.style[1]]
            painter.line(pixels, path, edge, width, ends[1], ends[0] == "round", pattern)
        elif mark.glow is not None and isinstance(shape, Region):
            painter.glow(pixels, shape.rings[0], *mark.glow, face)
        elif isinstance(shape, Segments):
            for points in shape.points:
                painter.line(pixels, points, edge, width, ends[1], ends[0] == "round")
        elif isinstance(shape, Spots):
            painter.discs(pixels, shape.points, shape.radius, face, edge, width)
        elif isinstance(shape, Circle):
            painter.circle(pixels, shape.x, shape.y, shape.radius, face, edge, width)
        elif isinstance(shape, Region) and len(shape.rings) == 1:
            painter.polygon(pixels, shape.rings[0], face, edge, width, ends[1])
        elif isinstance(shape, Line) and fill is None:
            painter.line(pixels, shape.points, edge, width, ends[1], ends[0] == "round")
        else:
            canvas.unknown = True
            _draw(renderer, ax, mark, face, (edge, width / per_point), ends)


def _draw(renderer: Any, ax: Any, mark: Mark, face: Any, stroke: tuple[Any, float], ends: tuple[str, str]) -> None:
    """Let Agg draw a mark, given its colour of fill, colour and width [points] of stroke."""
    context = renderer.new_gc()
    context.set_clip_rectangle(ax.bbox)
    context.set_capstyle(ends[0])
    context.set_joinstyle(ends[1])
    context.set_foreground(stroke[0], isRGBA=True)
    context.set_linewidth(stroke[1] if mark.stroke.color is not None else 0.0)
    renderer.draw_path(
        context, geometry_path(mark.geometry), ax.transData.frozen(), None if mark.fill is None else face
    )
    context.restore()


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
