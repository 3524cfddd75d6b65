"""Figures that update themselves before they are drawn, and windows that show them if there is a screen."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from irsim.common.screen import WINDOWLESS_BACKENDS, has_screen
from irsim.graphics.figure.figure import inches

__all__ = ["LiveCanvas", "LiveFigure", "Shown", "Window", "has_screen", "open_window"]


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


class Window:
    """A figure on the screen, managed by pyplot."""

    def __init__(self, figure: Figure) -> None:
        self.figure = figure
        self._shown = False

    @property
    def open(self) -> bool:
        """Whether the window is still open."""
        from matplotlib import pyplot

        return pyplot.fignum_exists(self.figure.number)

    def refresh(self, seconds: float) -> None:
        """Show the canvas and process window events for this long."""
        canvas: Any = self.figure.canvas
        if not self._shown:
            canvas.manager.show()
            self._shown = True
        if hasattr(canvas, "blit"):
            canvas.blit(self.figure.bbox)
        canvas.start_event_loop(max(seconds, 1e-3))

    def wait(self) -> None:
        """Wait until the user closes the window."""
        from matplotlib import pyplot

        while self.open:
            pyplot.pause(0.1)

    def close(self) -> None:
        """Close the window."""
        from matplotlib import pyplot

        pyplot.close(self.figure)


def open_window(size: tuple[float, float], dpi: float, *, full: bool, title: str) -> Window | None:
    """Open a new window.

    Args:
        size: Width and height of the figure [px].
        dpi: Pixels per inch.
        full: Fill the screen.
        title: Title of the window.

    Returns:
        The window, or None without a screen or a GUI toolkit.
    """
    if not has_screen():
        return None
    from matplotlib import pyplot

    try:
        figure = pyplot.figure(num=None, figsize=inches(size, dpi), dpi=dpi, FigureClass=LiveFigure)
    except Exception:  # without a screen, each toolkit raises its own kind of error
        return None
    manager = figure.canvas.manager
    if (
        pyplot.get_backend().lower() in WINDOWLESS_BACKENDS
        or manager is None
        or not hasattr(figure.canvas, "copy_from_bbox")
    ):
        pyplot.close(figure)
        return None
    manager.set_window_title(title)
    if full:
        manager.full_screen_toggle()
    return Window(figure)
