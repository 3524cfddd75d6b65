"""Drawing side of an environment: the figure is made when something is first drawn, and never in headless mode."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.env.access import EnvAccess
from irsim.env.parameters import PathParam, WorldParam

if TYPE_CHECKING:
    from irsim.common.log import Logger
    from irsim.graphics.scene.palette import Palette
    from irsim.rendering.env_plot import EnvPlot

__all__ = ["EnvDrawing"]


class EnvDrawing(EnvAccess):
    """Status, render, save_figure, draw_* and the animation of an environment."""

    logger: Logger
    palette_param: Palette
    path_param: PathParam
    display: bool
    headless: bool
    save_ani: bool
    full: bool
    ani_kwargs: dict[str, Any]
    world_param: WorldParam
    pause_flag: bool
    debug_flag: bool
    quit_flag: bool
    reset_flag: bool
    reload_flag: bool
    save_figure_flag: bool
    _label: str | None

    def _start_drawing(self) -> None:
        self._plot: EnvPlot | None = None
        self._title: str | None = None
        if not self.headless and "matplotlib.pyplot" in sys.modules:
            self._env_plot.list_in_pyplot()

    @property
    def status(self) -> str:
        """One word for titles: Arrived, Collision, Pause, Running, …."""
        if self.pause_flag:
            return "Pause"
        simulation = self._simulation
        if simulation.robots.any():
            if simulation.arrived[simulation.robots].all():
                return "Arrived"
            if simulation.collided[simulation.robots].any():
                return "Collision"
        if self._label is not None:
            return self._label
        for word in ("Reset", "Reload", "Save Figure", "Quit"):
            if getattr(self, f"{word.lower().replace(' ', '_')}_flag"):
                return word
        if self.debug_flag:
            return "Pause (Debugging)"
        return "Running (keyboard)" if self.world_param.control_mode == "keyboard" else "Running"

    def set_status(self, status: str) -> None:
        """Label shown until the next step."""
        self._label = str(status)

    @property
    def disable_all_plot(self) -> bool:
        """Alias of ``headless``."""
        return self.headless

    @property
    def _env_plot(self) -> EnvPlot:
        """The figure, made when first asked for."""
        if self._plot is None:
            self._plot = self._new_plot()
            if self._title is not None:
                self._plot.set_title(self._title)
        return self._plot

    def _new_plot(self) -> EnvPlot:
        from irsim.rendering.env_plot import EnvPlot

        return EnvPlot(self, display=self.display, full=self.full, palette=self.palette_param, attach=self._attach)

    def _attach(self, ax: Any) -> None:
        """The figure was made."""

    def _detach(self) -> None:
        """The figure goes away."""

    def _carry_out(self) -> None:
        """What was asked for between two frames."""

    def render(
        self,
        interval: float = 0.01,
        figure_kwargs: Mapping[str, Any] | None = None,
        mode: str = "dynamic",
        **kwargs: Any,
    ) -> None:
        """Bring the figure up to date (every ``sample_time``), then do what keys have asked for.

        Headless, nothing is drawn.

        Args:
            interval: Seconds to show the frame, where there is a window.
            figure_kwargs: Options of the saved frame.
            mode: Which objects to update: ``dynamic``, ``static`` or ``all``.
            **kwargs: Object plot options that hold for this frame.
        """
        if self._world.sampling and not self.headless:
            plot = self._env_plot
            plot.update(mode, **kwargs)
            if self.save_ani:
                plot.add_frame(**dict(figure_kwargs or {}))
            if self.display:
                plot.pause(interval)
        self._carry_out()

    def save_figure(
        self, save_name: str | Path | None = None, include_index: bool = False, save_gif: bool = False, **kwargs: Any
    ) -> Path | None:
        """Save the present picture.

        Args:
            save_name: File name with format (default ``<world>.png``), in the folder ``figure`` beside the script
                unless it is an absolute path.
            include_index: Append ``_<step, 4 digits>``.
            save_gif: Save into the animation buffer folder instead.
            **kwargs: Options of Matplotlib's ``savefig``: ``dpi``, ``bbox_inches``, ``transparent``, …

        Returns:
            The file written; None in headless mode.
        """
        if self.headless:
            return None
        return self._env_plot.save_figure(save_name, include_index=include_index, save_gif=save_gif, **kwargs)

    def show(self) -> None:
        """Show the window and wait until it is closed."""
        if not self.headless:
            self._env_plot.show()

    def set_title(self, title: str) -> None:
        """Fixed title, until the next reset."""
        self._title = title
        if self._plot is not None:
            self._plot.set_title(title)

    def reset_plot(self) -> None:
        """Draw everything anew."""
        if self._plot is not None:
            self._plot.reset()

    def draw_trajectory(self, traj: Any, traj_type: str = "-", **kwargs: Any) -> None:
        """Draw a path: a list of columns or (2 or more, N) [m]; ``refresh=True`` removes it with the next frame."""
        if not self.headless:
            self._env_plot.draw_trajectory(traj, traj_type, **kwargs)

    def draw_points(self, points: Any, s: float = 30, c: Any = None, refresh: bool = True, **kwargs: Any) -> None:
        """Draw points: a list of points or (2, N) [m]; ``s`` in points squared."""
        if not self.headless:
            self._env_plot.draw_points(points, s, c, refresh, **kwargs)

    def draw_box(self, vertex: Any, refresh: bool = False, color: str = "-") -> None:
        """Draw a closed outline (2, N) [m]."""
        if not self.headless:
            self._env_plot.draw_box(vertex, refresh, color)

    def draw_quiver(self, point: Any, refresh: bool = False, **kwargs: Any) -> None:
        """Draw an arrow (x, y, u, v) [m]."""
        if not self.headless:
            self._env_plot.draw_quiver(point, refresh, **kwargs)

    def draw_quivers(self, points: Any, refresh: bool = False, **kwargs: Any) -> None:
        """Draw arrows (x, y, u, v) [m]."""
        if not self.headless:
            self._env_plot.draw_quivers(points, refresh, **kwargs)

    def _redraw(self) -> None:
        self._title = None
        if self._plot is not None:
            self._plot.reset()

    def _finish_drawing(self, ending_time: float, **kwargs: Any) -> None:
        self._detach()
        if self.headless:
            return
        if self.save_ani:
            self._env_plot.save_animation(**{**self.ani_kwargs, **kwargs})
        if self._plot is not None:
            if self.display and self._plot.made:
                self._plot.pause(ending_time)
            self._plot.close()
            self._plot = None
