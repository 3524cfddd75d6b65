"""One picture of a simulation in the style `modern`, as pixels."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.graphics.encoding.pixels import Pixels
from irsim.graphics.figure.layers import hint_colors
from irsim.graphics.figure.pictures import Pictures
from irsim.graphics.scene.scene import Bounds, Scene, region_extent
from irsim.rendering.modern.layout import PRINT_RATIO, Layout, fit
from irsim.rendering.modern.picture import Picture, new_figure, seen_part, theme_of
from irsim.rendering.modern.style import Request

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["StillPicture", "draw_still", "shown_world"]

Colors = list[tuple[int, int, int]]
MIN_SHARE = 0.2
"""A very flat or narrow world is shown with a margin, so that its shorter side has this share of the longer one."""


class StillPicture:
    """The picture of one moment, before its size is chosen.

    Args:
        simulation: The simulation.
        world: Index of the world.
        viewpoint: Point or object name to centre on; default: the one of the scenario.
        region: x_min, y_min, x_max, y_max [m] of the part to show; default: the whole world.
        overrides: Object plot keys.
        extra: Callback that adds marks or labels to the scene.

    Attributes:
        world_shown: x from, x to, y from, y to of what it shows [m].
        plans: Whether ways to goals are drawn, which is so unless the caller has added some.
        notes: Things that it left out.
        word: The state of the episode, as it says it.
    """

    def __init__(
        self,
        simulation: Simulation,
        world: int = 0,
        *,
        viewpoint: Any = None,
        region: Sequence[float] | None = None,
        overrides: Mapping[str, Any] | None = None,
        extra: Callable[[Scene], None] | None = None,
    ) -> None:
        source = simulation.scenario.source
        self.theme = theme_of(simulation)
        self._overrides = dict(overrides or {})
        self._pictures = Pictures(Path(source).parent if source else None)
        self._picture = Picture(simulation, self.theme, self._pictures, world)
        chosen = simulation.scenario.world.plot.viewpoint if viewpoint is None else viewpoint
        self.scene, self._builder = self._picture.plain(self._overrides, chosen)
        if region is not None:
            self.scene.look_at(region_extent(region))
        if extra is not None:
            extra(self.scene)
        self.world_shown = shown_world(seen_part(self.scene))
        own = {mark.part for mark in self.scene.marks}
        self.plans = "plan" not in own
        self.notes: list[str] = []
        self.word = ""

    def draw(self, layout: Layout, request: Request) -> tuple[Pixels, Colors]:
        """The pixels, and the colours that a reduced palette must keep."""
        scene = self._picture.draw(self.scene, self._builder, layout, request)
        self.notes, self.word = self._picture.notes, self._picture.word
        figure = new_figure(layout, self.theme, self._pictures)
        figure.show(scene, None)
        pixels, _ = figure.pixels(tight=False)
        return pixels, hint_colors(scene, self.theme.tokens.values())


def shown_world(world: Bounds) -> Bounds:
    """A part of a world with a margin where it is very flat or narrow, so that there is room for names."""
    x0, x1, y0, y1 = world
    right = max(0.0, MIN_SHARE * (y1 - y0) - (x1 - x0)) / 2
    up = max(0.0, MIN_SHARE * (x1 - x0) - (y1 - y0)) / 2
    return x0 - right, x1 + right, y0 - up, y1 + up


def draw_still(
    simulation: Simulation,
    world: int,
    *,
    size_px: int,
    title: str | None,
    labels: bool,
    printed: bool,
    axes: bool,
    zones: bool,
    overrides: Mapping[str, Any],
    **what: Any,
) -> tuple[Pixels, Colors, list[str]]:
    """Draw one moment.

    Args:
        simulation: The simulation.
        world: Index of the world.
        size_px: Longer side [px].
        title: In place of the name of the scenario.
        labels: Whether names, paths and goals are drawn where the scenario does not say so.
        printed: Whether it has the layout for print.
        axes: Whether coordinates are at the edge.
        zones: Whether zones are drawn.
        overrides: Object plot keys.
        what: Further arguments of :class:`StillPicture`.

    Returns:
        The pixels, the colours that a reduced palette must keep, and what was left out.
    """
    hidden = {} if labels else dict.fromkeys(("show_text", "show_goal", "show_trajectory"), False)
    keys = {**hidden, **overrides}
    picture = StillPicture(simulation, world, overrides=keys, **what)
    ratio = PRINT_RATIO if printed else 1.0
    layout = fit(picture.world_shown, size_px / ratio, printed=printed, ratio=ratio)
    request = Request(overrides=keys, axes=axes, title=title, zones=zones, plans=picture.plans)
    pixels, colors = picture.draw(layout, request)
    return pixels, colors, picture.notes
