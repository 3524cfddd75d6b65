"""From a simulation to a figure of the style `modern`: scene, layout and pass together."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from irsim.graphics.figure.figure import SceneFigure
from irsim.graphics.figure.pictures import BUNDLED, Pictures
from irsim.graphics.scene.scene import Bounds, Scene
from irsim.graphics.scene.theme import THEMES, Theme
from irsim.objects.drawing.scene_builder import SceneBuilder
from irsim.rendering.modern import frame
from irsim.rendering.modern.layout import Layout
from irsim.rendering.modern.style import BUILD_KEYS, ModernStyle, Request

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["Picture", "build_keys", "new_figure", "own_images", "seen_part", "theme_of"]


def theme_of(simulation: Simulation, name: str | None = None) -> Theme:
    """The theme with this name; by default the scenario's."""
    return THEMES[name or simulation.scenario.world.plot.theme]


def own_images(has_picture: Callable[[str], bool]) -> Callable[[str], bool]:
    """Which images stand for bodies: files of the user, but not the images of irsim, whose robots have glyphs."""
    return lambda name: name not in BUNDLED and has_picture(name)


def new_figure(layout: Layout, theme: Theme, pictures: Pictures, figure: Any = None) -> SceneFigure:
    """An empty figure of this layout."""
    page = frame.page_color(layout, theme)
    return SceneFigure(layout.size, layout.dpi, pictures=pictures, page=page, figure=figure)


def build_keys(simulation: Simulation, overrides: Mapping[str, Any]) -> dict[str, Any]:
    """Plot keys with which the scene is built."""
    keys = {key: value for key, value in {**BUILD_KEYS, **overrides}.items() if BUILD_KEYS.get(key, True) is not False}
    return {**BUILD_KEYS, **keys}


class Picture:
    """Makes scenes in the style `modern` of one world.

    Args:
        simulation: The simulation.
        world: Index of the world.
        theme: The colours.
        pictures: Images in place of bodies.
    """

    def __init__(self, simulation: Simulation, theme: Theme, pictures: Pictures, world: int = 0) -> None:
        self.simulation, self.world, self.theme = simulation, world, theme
        self._images = own_images(pictures.has)
        self._style = ModernStyle(simulation, world, theme)
        self._builders: dict[bool, SceneBuilder] = {}

    @property
    def notes(self) -> list[str]:
        """Things that the last picture left out."""
        return self._style.notes

    @property
    def word(self) -> str:
        """The state of the episode, as the last picture said it."""
        return self._style.word

    def plain(self, overrides: Mapping[str, Any] | None = None, viewpoint: Any = None) -> tuple[Scene, SceneBuilder]:
        """The scene before the pass, to which a caller may add, and what has made it."""
        at_start = int(self.simulation.count[self.world]) == 0
        builder = self._builders.get(at_start)
        if builder is None:
            builder = self._builders[at_start] = SceneBuilder(
                self.simulation, world=self.world, has_picture=self._images, ghosts=at_start
            )
        scene = builder.build(viewpoint=viewpoint, overrides=build_keys(self.simulation, overrides or {}))
        return scene, builder

    def draw(self, scene: Scene, builder: SceneBuilder, layout: Layout, request: Request) -> Scene:
        """The picture of a scene."""
        return self._style.draw(scene, builder, layout, request)


def seen_part(scene: Scene, region: Sequence[float] | None = None) -> Bounds:
    """X from, x to, y from, y to of what a scene shows [m], which its viewpoint may move."""
    x0, x1, y0, y1 = scene.extent
    if region is not None or scene.center is None:
        return x0, x1, y0, y1
    (x, y), right, up = scene.center, (x1 - x0) / 2, (y1 - y0) / 2
    return x - right, x + right, y - up, y + up
