"""Text drawn from cached bitmaps, which is fast because the same few words and ten digits appear in every frame."""

from __future__ import annotations

import copy
import math
import re
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.patheffects import PathEffectRenderer, Stroke
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from irsim.graphics.figure.canvas import Canvas

__all__ = ["Glyphs", "QuickText"]

_PIECES = re.compile(r"\d|\D+")
_MARGIN = 3
"""Margin [px] around a bitmap, for strokes that reach beyond the nominal box of the text."""
MAX_CACHED_PIECES = 2000
"""Number of bitmaps after which the cache is emptied."""


@dataclass(slots=True)
class _Piece:
    """A bitmap of a piece of text.

    Attributes:
        bitmap: (H, W, 4) pixels, top row first.
        below: Number of rows below the baseline.
        advance: Distance to the start of the next piece [px].
    """

    bitmap: Any
    below: int
    advance: float


class Glyphs:
    """Cache of bitmaps, by text, font, colour and resolution."""

    def __init__(self) -> None:
        self._known: dict[Hashable, _Piece] = {}

    def get(self, key: Hashable, make: Callable[[], _Piece]) -> _Piece:
        """Return the piece with this key; a new one is made by ``make``."""
        result = self._known.get(key)
        if result is None:
            if len(self._known) >= MAX_CACHED_PIECES:
                self._known.clear()
            result = self._known[key] = make()
        return result


class QuickText(Text):
    """A line of plain text; on a pixel canvas it is composed of cached bitmaps, at whole pixels.

    Args:
        glyphs: Cache that the texts of a figure share.
        **kwargs: Arguments of :class:`matplotlib.text.Text`.

    Attributes:
        halo: Colour and width [pt] of an outline, or None.
        covers: Whether the text lies on the page around the world, beyond the reach of what moves.
    """

    def __init__(self, glyphs: Glyphs, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._glyphs = glyphs
        self._composed: tuple[Any, list[_Piece]] | None = None
        self.halo: tuple[Any, float] | None = None
        self.covers = False

    def draw(self, renderer: Any) -> None:
        """Draw the text.

        Matplotlib draws rotated text, text with effects or several lines, and text on a vector canvas.
        """
        if not self.get_visible():
            return
        if not (self.axes and isinstance(renderer, RendererAgg) and self.paint_on(Canvas(self.axes, renderer))):
            if self.halo is not None:
                self.set_path_effects([self._outline()])
                super().draw(renderer)
                self.set_path_effects([])
            super().draw(renderer)  # stays a text in vector graphics, as effects would make it a path

    def _outline(self) -> Stroke:
        assert self.halo is not None
        return Stroke(linewidth=self.halo[1], foreground=self.halo[0], joinstyle="round")

    def paint_on(self, canvas: Canvas) -> bool:
        """Paint the text if it is plain; return whether that was done."""
        if not self._is_plain(canvas.renderer):
            return False
        if not self.get_text():
            return True
        pieces, across, up = self._layout(canvas.renderer, canvas)
        baseline = canvas.height - round(up)
        for piece in pieces:
            top = baseline + piece.below - piece.bitmap.shape[0]
            canvas.painter.image(canvas.pixels, piece.bitmap, round(across) - _MARGIN, top)
            across += piece.advance
        self.stale = False
        return True

    def move(self, x: float, y: float) -> None:
        """Set the position without telling the axes, which a frame in which something else changes does not need."""
        self._x, self._y = x, y

    def get_window_extent(self, renderer: Any = None, dpi: float | None = None) -> Bbox:
        """Return the bounding box of the text [px]."""
        if dpi is not None or not self.get_text() or not self._is_plain(renderer):
            return super().get_window_extent(renderer, dpi)
        pieces, across, up = self._layout(renderer)
        below = max(piece.below for piece in pieces) - _MARGIN
        height = max(piece.bitmap.shape[0] for piece in pieces) - 2 * _MARGIN
        return Bbox.from_bounds(across, up - below, sum(piece.advance for piece in pieces), height)

    def _is_plain(self, renderer: Any) -> bool:
        plain = not self.get_path_effects() and self.get_rotation() == 0 and "\n" not in self.get_text()
        return plain and isinstance(renderer, RendererAgg)

    def _layout(self, renderer: Any, canvas: Canvas | None = None) -> tuple[list[_Piece], float, float]:
        """Return the pieces, and the position of the first on the baseline [px]."""
        pieces = self._pieces(renderer)
        if canvas is not None and self.axes is not None and self.get_transform() is self.axes.transData:
            across, up = canvas.to_pixel(*self.get_position())
        else:
            across, up = map(float, self.get_transform().transform(self.get_unitless_position()))
        alignment = self.get_horizontalalignment()
        if alignment != "left":
            total = sum(piece.advance for piece in pieces)
            across -= total / 2 if alignment == "center" else total
        return pieces, across, up

    def _pieces(self, renderer: Any) -> list[_Piece]:
        """Return the bitmaps of the text, which are looked up again only if text, font, colour or halo have changed."""
        font, text = self.get_fontproperties(), self.get_text()
        names = font.get_family(), font.get_style(), font.get_variant(), font.get_weight(), font.get_stretch()
        rest = font.get_size(), font.get_file(), self.get_color(), self.get_alpha(), renderer.dpi, self.halo
        if self._composed is None or self._composed[0] != (text, names, rest):
            look = str(names), *rest
            texts = _PIECES.findall(text) if self.halo is None else [text]  # halos must not overlap
            pieces = [self._glyphs.get((one, look), partial(self._render_piece, one, renderer)) for one in texts]
            self._composed = (text, copy.deepcopy(names), rest), pieces
        return self._composed[1]

    def _render_piece(self, piece: str, renderer: Any) -> _Piece:
        properties = self.get_fontproperties()

        def width(text: str) -> float:
            return float(renderer.get_text_width_height_descent(text, properties, False)[0])

        _, height, descent = renderer.get_text_width_height_descent(piece + "lp", properties, False)
        advance = width(f"x{piece}x") - width("xx")
        below = math.ceil(descent) + _MARGIN
        new_renderer: Any = RendererAgg
        paper = new_renderer(math.ceil(advance) + 2 * _MARGIN, math.ceil(height) + 2 * _MARGIN, renderer.dpi)
        context = paper.new_gc()
        context.set_foreground(self.get_color())
        context.set_alpha(self.get_alpha())
        if self.halo is not None:
            outlined = PathEffectRenderer([self._outline()], paper)
            outlined.draw_text(context, _MARGIN, paper.height - below, piece, properties, 0)
        paper.draw_text(context, _MARGIN, paper.height - below, piece, properties, 0)
        context.restore()
        return _Piece(np.array(paper.buffer_rgba()), below, advance)
