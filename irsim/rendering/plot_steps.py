"""Drawing the parts of a frame one by one, with the method names that scripts of IR-SIM call."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.graphics.figure.layers import FogLayer, GridLayer
from irsim.graphics.scene.scene import Fog, GridImage, Scene
from irsim.objects.drawing.scene_builder import MODES
from irsim.objects.views import views
from irsim.simulation.fog import FOG_COLOR

if TYPE_CHECKING:
    from irsim.rendering.recording import Pictured

__all__ = ["PlotSteps"]


class PlotSteps:
    """Part of :class:`irsim.rendering.env_plot.EnvPlot` that scripts of IR-SIM call for each part of a frame.

    A figure follows its environment anyway, so most methods just bring the whole figure up to date. ``objects`` that
    do not belong to the environment are drawn by their own method ``plot``.
    """

    env: Pictured
    _hidden: set[int]

    if TYPE_CHECKING:

        @property
        def ax(self) -> Any:
            """See :class:`irsim.rendering.env_plot.EnvPlot`."""

        def update(self, mode: str = "dynamic", **overrides: Any) -> None:
            """See :class:`irsim.rendering.env_plot.EnvPlot`."""

        def save_animation(self, path: str | Path | None = None, **options: Any) -> Path | None:
            """See :class:`irsim.rendering.env_plot.EnvPlot`."""

        def synced_figure(self) -> Any:
            """See :class:`irsim.rendering.env_plot.EnvPlot`."""

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
            raise ValueError(f"unknown mode {mode!r}: choose one of {', '.join(MODES)}")
        chosen: Iterable[Any] = views(self.env.simulation) if objects is None else objects
        for view in chosen:
            if mode == "all" or (mode == "static") == view.static:
                self._hidden.add(view.id)
                view.plot_clear(all=True)
        self.synced_figure()

    def _without_hidden(self, scene: Scene) -> Scene:
        for name in ("marks", "beams", "labels", "pictures", "grids") if self._hidden else ():
            setattr(scene, name, [item for item in getattr(scene, name) if item.object not in self._hidden])
        return scene

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
            grid_map: (nx, ny) occupancy, 0 to 100. None stands for the map of the environment, which is drawn anyway.
            **kwargs: Properties of the image: ``alpha``, ``cmap``, ``zorder``, …
        """
        if grid_map is None:
            self.synced_figure()
            return
        levels = np.clip(np.asarray(grid_map), 0, 100).astype(np.uint8)
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
