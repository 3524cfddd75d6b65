"""A window, where there is a screen and a toolkit to draw on it; chosen when first needed, never at import."""

from __future__ import annotations

import os
import sys
from typing import Any

from matplotlib.figure import Figure

from irsim.graphics.figure.figure import inches
from irsim.graphics.figure.live_figure import LiveFigure

__all__ = ["Window", "has_screen", "open_window"]

_WITHOUT_WINDOW = ("agg", "cairo", "pdf", "pgf", "ps", "svg", "template")


def has_screen() -> bool:
    """Whether a window could appear at all: an X or Wayland display on Linux; MPLBACKEND may rule windows out."""
    if os.environ.get("MPLBACKEND", "").lower() in _WITHOUT_WINDOW:
        return False
    if sys.platform.startswith("linux"):
        return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    return True


class Window:
    """A figure on the screen, managed by pyplot."""

    def __init__(self, figure: Figure) -> None:
        self.figure = figure
        self._shown = False

    @property
    def open(self) -> bool:
        """Whether the user has not closed it."""
        from matplotlib import pyplot

        return pyplot.fignum_exists(self.figure.number)

    def refresh(self, seconds: float) -> None:
        """Show what was drawn into the canvas, and let the window live for some time."""
        canvas: Any = self.figure.canvas
        if not self._shown:
            canvas.manager.show()
            self._shown = True
        if hasattr(canvas, "blit"):
            canvas.blit(self.figure.bbox)
        canvas.start_event_loop(max(seconds, 1e-3))

    def wait(self) -> None:
        """Until the user closes it."""
        from matplotlib import pyplot

        while self.open:
            pyplot.pause(0.1)

    def close(self) -> None:
        """Remove it from the screen."""
        from matplotlib import pyplot

        pyplot.close(self.figure)


def open_window(size: tuple[float, float], dpi: float, *, full: bool, title: str) -> Window | None:
    """A new window, or None where none can be had.

    Args:
        size: Of the figure [px].
        dpi: Pixels per inch.
        full: Fill the screen.
        title: Of the window.
    """
    if not has_screen():
        return None
    from matplotlib import pyplot

    try:
        figure = pyplot.figure(num=None, figsize=inches(size, dpi), dpi=dpi, FigureClass=LiveFigure)
    except Exception:  # toolkits raise errors of their own when they find no screen
        return None
    manager = figure.canvas.manager
    if (
        pyplot.get_backend().lower() in _WITHOUT_WINDOW
        or manager is None
        or not hasattr(figure.canvas, "copy_from_bbox")
    ):
        pyplot.close(figure)
        return None
    manager.set_window_title(title)
    if full:
        manager.full_screen_toggle()
    return Window(figure)
