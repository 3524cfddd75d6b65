"""The keys of the section ``plot`` that are attributes of objects, and may be written at any time."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import ValidationError

from irsim.objects.base import SimObject

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ObjectRecord

__all__ = ["PLOT_KEYS", "ObjectPlotKeys", "with_plot_key"]

PLOT_KEYS = ("show_goal", "show_goal_text", "show_sensor", "show_trail", "trail_freq")
"""Keys of ``plot`` that are attributes of objects."""


class ObjectPlotKeys(SimObject):
    """What is drawn of one object, from the next frame on; part of :class:`irsim.objects.view.ObjectView`."""

    @property
    def show_goal(self) -> bool:
        """Whether the goal is drawn."""
        return bool(self.record.plot.show_goal)

    @property
    def show_goal_text(self) -> bool:
        """Whether the goal is labelled; needs ``show_text`` and ``show_goal`` of the section ``plot``."""
        return bool(self.record.plot.show_goal_text)

    @property
    def show_sensor(self) -> bool:
        """Whether the sensors are drawn."""
        return bool(self.record.plot.show_sensor)

    @property
    def show_trail(self) -> bool:
        """Whether snapshots of the footprint are drawn along the trajectory, including the part already driven."""
        return bool(self.record.plot.show_trail)

    @property
    def trail_freq(self) -> int:
        """Number of steps between two snapshots."""
        return int(self.record.plot.trail_freq)


def with_plot_key(record: ObjectRecord, name: str, value: Any) -> ObjectRecord:
    """Return a record with another value of a key of ``plot``.

    Raises:
        ValueError: The value is not valid.
    """
    plain = value.item() if isinstance(value, np.generic) else value
    try:
        plot = type(record.plot).model_validate({**record.plot.model_dump(exclude_unset=True), name: plain})
    except ValidationError as error:
        raise ValueError(f"{name!r} of {record.name!r}: {error.errors()[0]['msg']}, not {value!r}") from None
    return replace(record, plot=plot)
