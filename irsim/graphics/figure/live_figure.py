"""A figure that shows the present whenever somebody looks: drawn, saved or read pixel by pixel."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

__all__ = ["LiveCanvas", "LiveFigure", "Shown"]


class Shown(Protocol):
    """What a figure shows."""

    def before_drawing(self) -> None:
        """Bring the artists up to date; the figure is about to be drawn."""

    def is_outdated(self) -> bool:
        """Whether the pixels show another moment than the present one."""


def _nothing() -> Shown | None:
    return None


class LiveFigure(Figure):
    """Asks for the present before it is drawn, by whomever: ``canvas.draw()``, ``savefig``, a window.

    Attributes:
        shown: Gives what it shows; None once that is gone.
    """

    shown: Callable[[], Shown | None] = staticmethod(_nothing)

    def draw(self, renderer: Any) -> None:
        """Draw the present."""
        if (shown := self.shown()) is not None:
            shown.before_drawing()
        super().draw(renderer)


class LiveCanvas(FigureCanvasAgg):
    """Canvas of a figure without a window; its pixels may be read without drawing first."""

    def buffer_rgba(self) -> memoryview:
        """(height, width, 4) pixels of the present moment, uint8."""
        self._look()
        pixels: memoryview = FigureCanvasAgg.buffer_rgba(self)  # type: ignore[no-untyped-call]
        return pixels

    def tostring_argb(self) -> bytes:
        """The same pixels as bytes, alpha first."""
        self._look()
        pixels: bytes = FigureCanvasAgg.tostring_argb(self)  # type: ignore[no-untyped-call]
        return pixels

    def _look(self) -> None:
        shown = self.figure.shown() if isinstance(self.figure, LiveFigure) else None
        if shown is not None and shown.is_outdated():
            self.draw()  # type: ignore[no-untyped-call]
