"""A figure that updates itself before it is drawn, saved or read pixel by pixel."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

__all__ = ["LiveCanvas", "LiveFigure", "Shown"]


class Shown(Protocol):
    """The plot that a figure shows."""

    def before_drawing(self) -> None:
        """Bring the artists up to date, because the figure is about to be drawn."""

    def is_outdated(self) -> bool:
        """Whether the pixels show an earlier moment than the present one."""


def _no_plot() -> Shown | None:
    return None


class LiveFigure(Figure):
    """Updates its artists before every drawing, whether by ``canvas.draw()``, ``savefig`` or a window.

    Attributes:
        shown: Returns the plot that the figure shows, or None once that no longer exists.
    """

    shown: Callable[[], Shown | None] = staticmethod(_no_plot)

    def draw(self, renderer: Any) -> None:
        """Draw the present moment."""
        if (shown := self.shown()) is not None:
            shown.before_drawing()
        super().draw(renderer)


class LiveCanvas(FigureCanvasAgg):
    """Canvas of a figure without a window; reading its pixels draws first if they are outdated."""

    def buffer_rgba(self) -> memoryview:
        """Return the (height, width, 4) pixels of the present moment, uint8."""
        self._draw_if_outdated()
        pixels: memoryview = FigureCanvasAgg.buffer_rgba(self)  # type: ignore[no-untyped-call]
        return pixels

    def tostring_argb(self) -> bytes:
        """Return the pixels of the present moment as bytes, alpha first."""
        self._draw_if_outdated()
        pixels: bytes = FigureCanvasAgg.tostring_argb(self)  # type: ignore[no-untyped-call]
        return pixels

    def _draw_if_outdated(self) -> None:
        shown = self.figure.shown() if isinstance(self.figure, LiveFigure) else None
        if shown is not None and shown.is_outdated():
            self.draw()  # type: ignore[no-untyped-call]
