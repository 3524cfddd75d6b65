"""Style, size and visible part of the pictures of an environment, which are chosen before the first drawing."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.diagnostics.errors import InputError
from irsim.graphics.figure.figure import SceneFigure, fitting_size
from irsim.graphics.figure.overlay import Overlay
from irsim.graphics.figure.pictures import Pictures
from irsim.graphics.scene.scene import Bounds, Scene, region_extent
from irsim.graphics.scene.style import Palette
from irsim.rendering.modern.live import LiveStyle
from irsim.rendering.modern.style import USER_ZORDER
from irsim.rendering.recording import Pictured
from irsim.rendering.saving import saved_figure_options

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["PlotFormat"]


class PlotFormat:
    """The format of the pictures of one environment.

    Args:
        env: The environment.
        palette: Default colours of the style `classic`.
    """

    def __init__(self, env: Pictured, palette: Palette | None) -> None:
        self.env = env
        self.palette = palette or Palette()
        source = env.simulation.scenario.source
        self._pictures = Pictures(Path(source).parent if source else None, env.logger.warning)
        self._options = env.simulation.scenario.world.plot
        saved = saved_figure_options(self._options)
        self.saved_figure_kwargs: dict[str, Any] = {"dpi": 100, "bbox_inches": "tight", **saved}
        self._dpi = float(self.saved_figure_kwargs["dpi"])
        width, height = self._options.figure_pixels
        self._size = float(width), float(height)
        self._side: float | None = None
        self._overlay = Overlay(self.palette)
        self._figure: SceneFigure | None = None
        self._region: Bounds | None = None
        self._modern: LiveStyle | None = None
        self._chosen: tuple[str, str | None, bool] | None = None

    def set_style(self, style: str, theme: str | None = None, printed: bool = False) -> None:
        """Choose how the figure is drawn, before the first drawing.

        Args:
            style: ``modern`` or ``classic``.
            theme: ``light`` or ``dark``, of the style `modern`; None: the scenario's.
            printed: Whether it has the layout for print, in the style `modern`.
        """
        self._chosen = style, theme, printed
        self._modern = None
        if style == "modern":
            self._modern = LiveStyle(self.env.simulation, self._pictures, theme, printed)
            self._dpi = self._modern.dpi
            chosen = saved_figure_options(self._options)
            self.saved_figure_kwargs.update({"dpi": self._dpi, "bbox_inches": None, **chosen})
            self._overlay.zorder = USER_ZORDER
            self._fit()

    @property
    def tokens(self) -> list[str] | None:
        """Colours of the theme of the style `modern`; None in other styles."""
        return None if self._modern is None else list(self._modern.theme.tokens.values())

    def _renew_style(self) -> None:
        """Make the style again after a change of the simulation or the options; the figure keeps its size."""
        if self._modern is not None and self._chosen is not None:
            _, theme, printed = self._chosen
            layout = self._modern.layout
            self._modern = LiveStyle(self.env.simulation, self._pictures, theme, printed)
            self._modern.layout = layout

    def set_size(self, longer_side: float) -> None:
        """Set the longer side of pictures [px]; the other side follows from the world.

        Raises:
            ValueError: The size is not positive, or the figure has been made.
        """
        if not longer_side > 0:
            raise InputError(f"the size must be positive, not {longer_side}")
        if self._figure is not None:
            raise InputError("the size can only be set before the first drawing")
        self._side = longer_side
        self.saved_figure_kwargs["bbox_inches"] = None
        self._fit()

    def set_region(self, region: Sequence[float]) -> None:
        """Show only a part of the world: x_min, y_min, x_max, y_max [m].

        Raises:
            ValueError: The region is not valid.
        """
        self._region = region_extent(region)
        self._fit()

    def _fit(self) -> None:
        """Fit the size of the figure to the part of the world that it shows."""
        left, low, right, top = self.env.simulation.scenario.world.bounds
        x0, x1, y0, y1 = self._region or (left, right, low, top)
        if self._modern is not None:
            width, height = self._options.figure_pixels
            self._size = self._modern.begin((x0, x1, y0, y1), (float(width), float(height)), self._side)
        elif self._side is not None:
            axis = not self._options.no_axis
            self._size = fitting_size(x1 - x0, y1 - y0, self._side, self._dpi, axis=axis)

    def _new_figure(self, figure: Figure | None) -> SceneFigure:
        if self._modern is not None:
            return self._modern.figure(figure)
        return SceneFigure(
            self._size,
            self._dpi,
            axis=not self._options.no_axis,
            tight=self._options.tight,
            figure=figure,
            pictures=self._pictures,
        )

    def _modern_scene(
        self, modern: LiveStyle, overrides: dict[str, Any], viewpoint: Any, hidden: Collection[int], title: str | None
    ) -> Scene:
        """The picture of the present state in the style `modern`; an empty title leaves the line above it out."""
        return modern.scene(
            self._figure,
            overrides=overrides,
            viewpoint=viewpoint,
            region=self._region,
            hidden=hidden,
            title=title or None,
            show_title=title != "",
            zones=self._options.show_zones or "show_zones" not in self._options.model_fields_set,
        )
