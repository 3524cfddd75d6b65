"""Drawings of user code in the picture of an environment: by scripts, and by sensors of users."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from matplotlib.axes import Axes

from irsim.objects.sensors.sensors import PythonSensor

if TYPE_CHECKING:
    from irsim.graphics.figure.overlay import Overlay
    from irsim.objects.view import ObjectView

__all__ = ["ScriptDrawings", "UserSensors"]


class ScriptDrawings:
    """Part of :class:`irsim.rendering.env_plot.EnvPlot`: titles, trajectories, points, boxes and arrows of scripts."""

    title: str | None
    _overlay: Overlay

    if TYPE_CHECKING:

        def made_figure(self) -> Any:
            """See :class:`irsim.rendering.env_plot.EnvPlot`."""

    def set_title(self, title: str | None) -> None:
        """Set a fixed title until the next reset; None shows time and status again."""
        self.title = title

    def draw_trajectory(self, traj: Any, traj_type: str = "-", **kwargs: Any) -> None:
        """Draw a trajectory; see :meth:`Overlay.trajectory`."""
        self._overlay.trajectory(self.made_figure().ax, traj, traj_type, **kwargs)

    def draw_points(self, points: Any, s: float = 30, c: Any = None, refresh: bool = True, **kwargs: Any) -> None:
        """Draw dots; see :meth:`Overlay.points`."""
        if points is not None:
            self._overlay.points(self.made_figure().ax, points, s, c, refresh, **kwargs)

    def draw_box(self, vertex: Any, refresh: bool = False, color: str = "-") -> None:
        """Draw a closed outline; see :meth:`Overlay.box`."""
        self._overlay.box(self.made_figure().ax, vertex, refresh, color)

    def draw_quiver(self, point: Any, refresh: bool = False, color: Any = None, **kwargs: Any) -> None:
        """Draw one arrow (x, y, u, v)."""
        if point is not None:
            self._overlay.quivers(self.made_figure().ax, [point], refresh, color, **kwargs)

    def draw_quivers(self, points: Any, refresh: bool = False, color: Any = None, **kwargs: Any) -> None:
        """Draw arrows (x, y, u, v)."""
        self._overlay.quivers(self.made_figure().ax, points, refresh, color, **kwargs)


class UserSensors:
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
