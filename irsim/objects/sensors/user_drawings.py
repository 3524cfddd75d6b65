"""Drawings that sensors of users make by themselves, in the axes of a figure."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from irsim.objects.sensors.sensors import PythonSensor

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from irsim.objects.view import ObjectView

__all__ = ["UserDrawings"]


class UserDrawings:
    """Lets the user-defined sensors of an environment draw into the axes of one figure."""

    def __init__(self) -> None:
        self._drawn: dict[int, PythonSensor] = {}

    def show(self, ax: Axes, objects: Sequence[ObjectView]) -> None:
        """Bring the drawings of the sensors up to date.

        Args:
            ax: Axes in world coordinates.
            objects: Objects whose sensors are shown.
        """
        sensors = [sensor for view in objects for sensor in view.sensors if isinstance(sensor, PythonSensor)]
        for sensor in [*self._drawn.values()]:
            if sensor not in sensors:
                del self._drawn[id(sensor)]
                if hasattr(sensor.instance, "plot_clear"):
                    sensor.instance.plot_clear()
        for sensor in sensors:
            if id(sensor) in self._drawn:
                if hasattr(sensor.instance, "step_plot"):
                    sensor.instance.step_plot()
            elif hasattr(sensor.instance, "plot"):
                self._drawn[id(sensor)] = sensor
                sensor.instance.plot(ax, sensor.parent.state)

    def forget(self) -> None:
        """Forget which sensors have drawn, because the axes are empty again."""
        self._drawn.clear()
