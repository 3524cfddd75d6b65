"""The picture of an environment with all methods of IR-SIM 2.12: parts of a frame, drawings of scripts, the window."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from irsim.components.maps._grid import shades
from irsim.diagnostics.errors import InputError
from irsim.graphics.figure import window
from irsim.graphics.figure.image_layers import FogLayer, GridLayer
from irsim.graphics.scene.scene import Fog, GridImage
from irsim.objects.drawing.scene_builder import MODES
from irsim.objects.views import views
from irsim.rendering import env_plot
from irsim.simulation.fog import FOG_COLOR

__all__ = ["EnvPlot"]


class EnvPlot(env_plot.EnvPlot):
    """The picture of an environment with the methods that scripts call.

    A figure follows its environment anyway, so most methods just bring the whole figure up to date. ``objects`` that
    do not belong to the environment are drawn by their own method ``plot``.
    """

    @property
    def x_range(self) -> list[float]:
        """[xmin, xmax] of the world [m]."""
        world = self.env.simulation.scenario.world
        return [float(world.offset[0]), float(world.offset[0] + world.width)]

    @property
    def y_range(self) -> list[float]:
        """[ymin, ymax] of the world [m]."""
        world = self.env.simulation.scenario.world
        return [float(world.offset[1]), float(world.offset[1] + world.height)]

    @property
    def logger(self) -> Any:
        """The logger of the environment."""
        return self.env.logger

    def step(self, mode: str = "dynamic", objects: Iterable[Any] | None = None, **kwargs: Any) -> None:
        """Bring figure and title up to date.

        Args:
            mode: Objects that ``kwargs`` apply to: ``dynamic``, ``static`` or ``all``.
            objects: Additional objects to draw.
            **kwargs: Object plot keys that stay in force until the next call.
        """
        self.update(mode, **kwargs)
        self.synced_figure()
        own = {id(view) for view in views(self.env.simulation)}
        for view in objects or ():
            if id(view) not in own:
                view.plot(self.ax, **kwargs)

    step_objects_plot = step

    def draw_components(self, mode: str = "all", objects: Iterable[Any] | None = None, **kwargs: Any) -> None:
        """Draw everything, including what ``clear_components`` has removed; see :meth:`step`."""
        self.step(mode, objects, **kwargs)

    def init_objects_plot(self, objects: Iterable[Any] | None = None, **kwargs: Any) -> None:
        """Draw objects for the first time; see :meth:`step`."""
        self.step("all", objects, **kwargs)

    def clear_components(self, mode: str = "all", objects: Iterable[Any] | None = None) -> None:
        """Remove objects from the picture until the next frame.

        Args:
            mode: Which objects to remove: ``dynamic``, ``static`` or ``all``.
            objects: Objects to choose from; default: all objects of the environment.

        Raises:
            ValueError: The mode is unknown.
        """
        if mode not in MODES:
            raise InputError(f"unknown mode {mode!r}", f"choose one of {', '.join(MODES)}")
        chosen: Iterable[Any] = views(self.env.simulation) if objects is None else objects
        for view in chosen:
            if mode == "all" or (mode == "static") == view.static:
                self._hidden.add(view.id)
                view.plot_clear(all=True)
        self.synced_figure()

    def step_world_plot(self) -> None:
        """Bring the fog and everything else up to date."""
        self.synced_figure()

    def update_title(self) -> None:
        """Bring the title and everything else up to date."""
        self.synced_figure()

    def set_ax_viewpoint(self, objects: Iterable[Any] | None = None) -> None:
        """Centre the view on the ``viewpoint`` of the scenario.

        Args:
            objects: Ignored; IR-SIM 2.12 searched the viewpoint among them.
        """
        self.synced_figure()

    def draw_grid_map(self, grid_map: Any = None, **kwargs: Any) -> None:
        """Draw an additional map over the whole world.

        Args:
            grid_map: (nx, ny) occupancy, 0 to 100, negative where unknown. None stands for the map of the environment,
                which is drawn anyway.
            **kwargs: Properties of the image: ``alpha``, ``cmap``, ``zorder``, …
        """
        if grid_map is None:
            self.synced_figure()
            return
        levels = shades(grid_map)
        layer = GridLayer(self.ax, 0.0)
        layer.show(GridImage(-1, levels, (*self.x_range, *self.y_range), 0.0))  # type: ignore[arg-type]
        layer.artist.set(**kwargs)

    def draw_fog(self, fog_map: Any = None, zorder: int = 2, **kwargs: Any) -> None:
        """Draw an additional fog.

        Args:
            fog_map: A :class:`irsim.simulation.fog.FogMap`. None stands for the fog of the environment, which is drawn
                anyway.
            zorder: Layer of the image.
            **kwargs: ``color`` and ``alpha``.
        """
        if fog_map is None:
            self.synced_figure()
            return
        x, y = fog_map.world_offset
        extent = x, x + fog_map.width, y, y + fog_map.height
        color, alpha = kwargs.get("color", FOG_COLOR), float(kwargs.get("alpha", 1.0))
        FogLayer(self.ax, zorder).show(Fog(fog_map.explored, extent, color, alpha, zorder))

    def save_animate(
        self,
        ani_name: str = "animation",
        suffix: str = ".gif",
        last_frame_duration: float = 1,
        rm_fig_path: bool = True,
        **kwargs: Any,
    ) -> Path | None:
        """Write the animation; see :meth:`irsim.rendering.env_plot.EnvPlot.save_animation`."""
        options = {"ani_name": ani_name, "suffix": suffix, "rm_fig_path": rm_fig_path, **kwargs}
        return self.save_animation(last_frame_duration=last_frame_duration, **options)

    # drawings of scripts ---------------------------------------------------------------------------------------------
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

    # the window ------------------------------------------------------------------------------------------------------
    def pause(self, interval: float) -> None:
        """Show the present state in the window or notebook for ``interval`` seconds; without one return at once."""
        if not self._display or self.show_in_cell(interval):
            return
        if self._figure is None:
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
