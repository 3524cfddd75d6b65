"""Lists the figures of environments in pyplot, so that ``plt.gcf()`` and ``plt.savefig()`` find them.

This module does not import pyplot, which is slow: pyplot's list of figures is a separate module of Matplotlib. If a
script has imported pyplot before it makes an environment, the environment is listed at once, and its figure is made
when pyplot asks for it; otherwise the figure is listed when it is made. The entry is removed after ``env.end()``, or
when the environment no longer exists.
"""

from __future__ import annotations

import atexit
from collections.abc import Callable
from typing import Any

from matplotlib._pylab_helpers import Gcf
from matplotlib.backend_bases import FigureManagerBase

__all__ = ["PyplotEntry"]


class PyplotEntry(FigureManagerBase):
    """Figure manager of pyplot for a figure without a window, which is possibly not made yet.

    Args:
        make: Makes the figure and returns its canvas, or None if the environment no longer exists.
    """

    def __init__(self, make: Callable[[], Any]) -> None:
        self._make = make
        self._canvas: Any = None
        self._title = ""
        self._cidgcf: int | None = None
        self.key_press_handler_id = self.button_press_handler_id = self.scroll_handler_id = None
        self.toolmanager = self.toolbar = None
        self.num: Any = max(Gcf.figs, default=0) + 1
        Gcf.set_active(self)

    @property
    def made(self) -> bool:
        """Whether the figure exists."""
        return self._canvas is not None

    @property
    def canvas(self) -> Any:  # type: ignore[override]
        """The canvas of the figure, made when first asked for."""
        if self._canvas is None:
            self._canvas = self._make()
        return self._canvas

    def adopt(self, canvas: Any) -> None:
        """Manage the canvas of a figure that was made without a window."""
        self._canvas = canvas
        canvas.manager = self
        canvas.figure._number = self.num
        if not hasattr(canvas.figure, "number"):  # before Matplotlib 3.10
            canvas.figure.number = self.num

    def give_way(self, canvas: Any) -> None:
        """Remove this entry, because the figure has a window, which pyplot lists itself."""
        self._canvas = canvas
        self.leave()

    def leave(self) -> None:
        """Remove this entry from pyplot's list."""
        if Gcf.figs.get(self.num) is self:
            Gcf.figs.pop(self.num)

    def get_window_title(self) -> str:
        """Return the title that a window would have."""
        return self._title

    def set_window_title(self, title: str) -> None:
        """Store the title; no window shows it."""
        self._title = title

    def show(self) -> None:
        """Do nothing, because the figure has no window."""


def active() -> Any:
    """Return the manager of pyplot's current figure, or None without one."""
    return Gcf.get_active()


def activate(manager: Any) -> None:
    """Make a figure pyplot's current one."""
    Gcf.set_active(manager)


def _forget_unmade() -> None:
    """Remove the entries of figures that were never made, so that pyplot does not make them only to close them."""
    for manager in list(Gcf.figs.values()):
        if isinstance(manager, PyplotEntry) and not manager.made:
            manager.leave()


atexit.register(_forget_unmade)
