"""Figures of environments among those of pyplot, so that ``plt.gcf()`` and ``plt.savefig()`` find them.

Nothing here imports pyplot: its list of figures is a module of its own. An environment made after a script has imported
pyplot is listed at once, and its figure made when pyplot asks for it; any other is listed when its figure is made. An
entry goes with the figure: after ``env.end()``, or when the environment is gone.
"""

from __future__ import annotations

import atexit
from collections.abc import Callable
from typing import Any

from matplotlib._pylab_helpers import Gcf
from matplotlib.backend_bases import FigureManagerBase

__all__ = ["PyplotEntry"]


class PyplotEntry(FigureManagerBase):
    """Manager, in the sense of pyplot, of a figure that has no window and may not be made yet.

    Args:
        make: Makes the figure and gives its canvas; None when the environment is gone.
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
        """The figure was made, without a window."""
        self._canvas = canvas
        canvas.manager = self
        canvas.figure._number = self.num
        if not hasattr(canvas.figure, "number"):  # before Matplotlib 3.10
            canvas.figure.number = self.num

    def give_way(self, canvas: Any) -> None:
        """The figure has got a window, which pyplot lists by itself."""
        self._canvas = canvas
        self.leave()

    def leave(self) -> None:
        """Be listed no longer."""
        if Gcf.figs.get(self.num) is self:
            Gcf.figs.pop(self.num)

    def get_window_title(self) -> str:
        """What a window would be called."""
        return self._title

    def set_window_title(self, title: str) -> None:
        """Keep the title; there is no window."""
        self._title = title

    def show(self) -> None:
        """Nothing: there is no window."""


def active() -> Any:
    """The manager of the current figure of pyplot, None without one."""
    return Gcf.get_active()


def activate(manager: Any) -> None:
    """Make a figure the current one of pyplot."""
    Gcf.set_active(manager)


def _forget_unmade() -> None:
    """At the end of the program no figure is made just to be closed."""
    for manager in list(Gcf.figs.values()):
        if isinstance(manager, PyplotEntry) and not manager.made:
            manager.leave()


atexit.register(_forget_unmade)
