"""The style `modern` of the figure of an environment, which follows it from frame to frame."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING, Any

from irsim.graphics.figure.figure import SceneFigure
from irsim.graphics.figure.pictures import Pictures
from irsim.graphics.scene.scene import Bounds, Scene
from irsim.rendering.modern.layout import PRINT_RATIO, PRINT_SIDE, Layout, fit
from irsim.rendering.modern.picture import Picture, new_figure, seen_part, theme_of
from irsim.rendering.modern.style import Request

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["LiveStyle"]


class LiveStyle:
    """Pictures of one environment.

    Args:
        simulation: The simulation.
        pictures: Images in place of bodies.
        theme: Name of the theme; None: the scenario's.
        printed: Whether pictures have the layout for print.

    Attributes:
        layout: The layout of the last picture.
    """

    def __init__(self, simulation: Simulation, pictures: Pictures, theme: str | None, printed: bool) -> None:
        self.theme, self.printed = theme_of(simulation, theme), printed
        self.pictures = pictures
        self._picture = Picture(simulation, self.theme, pictures)
        self.ratio = PRINT_RATIO if printed else 1.0
        self.layout: Layout | None = None

    @property
    def dpi(self) -> float:
        """Pixels per inch."""
        return 96.0 * self.ratio

    def begin(self, world: Bounds, size: tuple[float, float], side: float | None) -> tuple[float, float]:
        """Choose the layout of the first picture, and return its size [px].

        Args:
            world: x from, x to, y from, y to of what is shown [m].
            size: Greatest width and height [px].
            side: Longer side instead [px].
        """
        if self.printed:
            units = PRINT_SIDE if side is None else side / self.ratio
            self.layout = fit(world, units, printed=True, ratio=self.ratio)
        elif side is not None:
            self.layout = fit(world, side)
        else:
            self.layout = fit(world, max(size), box=size)
        width, height = self.layout.size
        return float(width), float(height)

    def figure(self, figure: Any) -> SceneFigure:
        """An empty figure."""
        assert self.layout is not None
        return new_figure(self.layout, self.theme, self.pictures, figure)

    def scene(
        self,
        shown: SceneFigure | None,
        *,
        overrides: Mapping[str, Any],
        viewpoint: Any,
        region: Bounds | None,
        hidden: Collection[int],
        title: str | None,
        show_title: bool,
        zones: bool,
    ) -> Scene:
        """The picture of the present state.

        Args:
            shown: The figure whose size it has.
            overrides: Plot keys of this frame.
            viewpoint: Point or name of an object on which it is centred.
            region: x from, x to, y from, y to of the part that it shows instead [m].
            hidden: Ids of objects that are left out.
            title: In place of the name of the scenario.
            show_title: Whether there is a line above the world.
            zones: Whether zones are drawn.
        """
        scene, builder = self._picture.plain(overrides, viewpoint)
        if region is not None:
            scene.look_at(region)
        for name in ("marks", "beams", "labels", "pictures", "grids") if hidden else ():
            setattr(scene, name, [item for item in getattr(scene, name) if item.object not in hidden])
        world = seen_part(scene)
        width, height = (1.0, 1.0) if shown is None else (shown.figure.bbox.width, shown.figure.bbox.height)
        layout = self.layout
        assert layout is not None
        if shown is not None and (round(width), round(height)) != layout.size:
            box = float(width) / self.ratio, float(height) / self.ratio
            layout = fit(world, max(box), box=box, printed=self.printed, ratio=self.ratio, fill=True)
        self.layout = layout = layout.moved(world)
        request = Request(overrides=overrides, title=title, head=show_title, zones=zones)
        return self._picture.draw(scene, builder, layout, request)
