"""How pictures show one object, as attributes that scripts may write at any time: labels and keys of ``plot``."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from irsim.common.text import clean
from irsim.objects.base import SimObject
from irsim.objects.lifecycle import replace_plot
from irsim.objects.setters import changed_options

__all__ = ["PLOT_KEYS", "Drawing"]

_NO_GLYPHS = "\u2e80"
"""First of the letters, such as Chinese ones, that the fonts of pictures lack."""
MAX_LABEL = 24
"""Number of characters of a name that pictures show."""
PLOT_KEYS = ("show_goal", "show_goal_text", "show_sensor", "show_trail", "trail_freq")
"""Keys of ``plot`` that may be written."""


class Drawing:
    """How one object is drawn, ``robot.drawing``; a change takes effect from the next frame on.

    Attributes:
        text: Text that is drawn in place of ``label``; None shows ``label``.
        goal_text: Text that is drawn at the goal in place of ``G-`` and ``label``; None shows these.
    """

    text: str | None
    goal_text: str | None

    def __init__(self, view: SimObject) -> None:
        self.__dict__.update(_view=view, text=None, goal_text=None)

    def __setattr__(self, name: str, value: Any) -> None:
        view: SimObject = self.__dict__["_view"]
        if name in PLOT_KEYS:
            plot = changed_options(view.record.plot, repr(view.record.name), **{name: value})
            replace_plot(view, replace(view.record, plot=plot))
        else:
            object.__setattr__(self, name, value)

    @property
    def short_label(self) -> str:
        """Role and number: ``r0``, ``o3``."""
        view: SimObject = self.__dict__["_view"]
        return f"{view.role[0]}{view.id}"

    @property
    def label(self) -> str:
        """Name in pictures: the one that the user gave, if fonts have its letters; else ``short_label``."""
        view: SimObject = self.__dict__["_view"]
        unnamed = not view.record.is_named or max(view.name, default="") >= _NO_GLYPHS
        return self.short_label if unnamed else clean(view.name, MAX_LABEL)

    @property
    def show_goal(self) -> bool:
        """Whether the goal is drawn."""
        return bool(self._plot.show_goal)

    @property
    def show_goal_text(self) -> bool:
        """Whether the goal is labelled; needs ``show_text`` and ``show_goal`` of the section ``plot``."""
        return bool(self._plot.show_goal_text)

    @property
    def show_sensor(self) -> bool:
        """Whether the sensors are drawn."""
        return bool(self._plot.show_sensor)

    @property
    def show_trail(self) -> bool:
        """Whether snapshots of the footprint are drawn along the trajectory, including the part already driven."""
        return bool(self._plot.show_trail)

    @property
    def trail_freq(self) -> int:
        """Number of steps between two snapshots."""
        return int(self._plot.trail_freq)

    @property
    def _plot(self) -> Any:
        return self.__dict__["_view"].record.plot
