"""Mouse control: pointer position, clicks, and zooming with the wheel."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["MouseControl"]

MIN_ZOOM_FACTOR = 1.1
"""Smallest ratio of one wheel step."""
_LEFT = 1
_MIDDLE = 2
_RIGHT = 3


class MouseControl:
    """Tracks the mouse over one pair of axes.

    Args:
        ax: Matplotlib axes in world coordinates [m].
        zoom_factor: Ratio by which one wheel step zooms, at least 1.1.

    Attributes:
        mouse_pos: (x, y) under the pointer, rounded to 0.01 m; None outside the axes.
        left_click_pos, right_click_pos: (2,) position at which that button was pressed; None while it is up.
    """

    def __init__(self, ax: Any, zoom_factor: float = MIN_ZOOM_FACTOR) -> None:
        self.ax = ax
        self.mouse_pos: tuple[float, float] | None = None
        self.left_click_pos: NDArray[np.float64] | None = None
        self.right_click_pos: NDArray[np.float64] | None = None
        self._home: tuple[Any, Any] | None = None
        self.set_zoom_factor(zoom_factor)
        canvas = ax.figure.canvas
        events = {
            "motion_notify_event": self.on_move,
            "button_press_event": self.on_click,
            "button_release_event": self.on_release,
            "scroll_event": self.on_scroll,
            "axes_leave_event": self._leave,
        }
        self._connections = [(canvas, canvas.mpl_connect(name, call)) for name, call in events.items()]

    def set_zoom_factor(self, zoom_factor: float) -> None:
        """Set the ratio by which one wheel step zooms; less than 1.1 counts as 1.1."""
        self.zoom_factor = max(MIN_ZOOM_FACTOR, float(zoom_factor))

    def reset_zoom(self) -> None:
        """Return to the view before the first zoom."""
        if self._home is not None:
            self.ax.set_xlim(*self._home[0])
            self.ax.set_ylim(*self._home[1])
            self._home = None

    def forget_zoom(self) -> None:
        """Forget the view before the first zoom, because the axes have been drawn again."""
        self._home = None

    def stop(self) -> None:
        """Disconnect from the figure."""
        for canvas, number in self._connections:
            canvas.mpl_disconnect(number)
        self._connections = []

    def _position(self, event: Any) -> tuple[float, float] | None:
        """Return the position of an event in world coordinates [m], or None outside the axes."""
        if event.inaxes is not self.ax or event.xdata is None:
            return None
        return round(float(event.xdata), 2), round(float(event.ydata), 2)

    def on_move(self, event: Any) -> None:
        """Handle a movement of the pointer."""
        self.mouse_pos = self._position(event)

    def _leave(self, _: Any) -> None:
        self.mouse_pos = None

    def on_click(self, event: Any) -> None:
        """Handle a button press."""
        position = self._position(event)
        if position is None:
            return
        if event.button == _LEFT:
            self.left_click_pos = np.array(position)
        elif event.button == _RIGHT:
            self.right_click_pos = np.array(position)
        elif event.button == _MIDDLE:
            self.reset_zoom()

    def on_release(self, event: Any) -> None:
        """Handle a button release."""
        if event.button == _LEFT:
            self.left_click_pos = None
        elif event.button == _RIGHT:
            self.right_click_pos = None

    def on_scroll(self, event: Any) -> None:
        """Zoom about the point under the pointer, which keeps its position on the screen."""
        if event.inaxes is not self.ax or event.xdata is None:
            return
        limits = self.ax.get_xlim(), self.ax.get_ylim()
        if self._home is None:
            self._home = limits
        scale = self.zoom_factor if event.button == "down" else 1.0 / self.zoom_factor
        for (low, high), centre, set_limits in zip(
            limits, (event.xdata, event.ydata), (self.ax.set_xlim, self.ax.set_ylim), strict=True
        ):
            set_limits(centre - (centre - low) * scale, centre + (high - centre) * scale)
