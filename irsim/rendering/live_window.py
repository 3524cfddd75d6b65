"""Showing an environment in a window while it runs."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from irsim.graphics.figure.figure import SceneFigure
    from irsim.graphics.figure.window import Window

__all__ = ["LiveWindow"]


class LiveWindow:
    """Part of :class:`irsim.rendering.env_plot.EnvPlot` that shows frames in its window."""

    _display: bool
    _figure: SceneFigure | None
    _window: Window | None

    if TYPE_CHECKING:

        def made_figure(self) -> SceneFigure:
            """See :class:`irsim.rendering.env_plot.EnvPlot`."""

        def synced_figure(self) -> SceneFigure:
            """See :class:`irsim.rendering.env_plot.EnvPlot`."""

        def as_shown(self) -> AbstractContextManager[None]:
            """See :class:`irsim.rendering.env_plot.EnvPlot`."""

    def pause(self, interval: float) -> None:
        """Show the present state in the window for ``interval`` seconds; without a window return at once."""
        if not self._display:
            return
        if self._figure is None:
            from irsim.graphics.figure import window

            if not window.has_screen():
                return
            self.made_figure()
        if self._window is not None and self._window.open:
            figure = self.synced_figure()
            with self.as_shown():
                figure.draw()
            self._window.refresh(interval)

    def show(self) -> None:
        """Show the window until the user closes it; without a window return at once."""
        self.pause(0.001)
        if self._window is not None:
            self._window.wait()
