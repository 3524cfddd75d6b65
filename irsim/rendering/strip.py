"""A strip: several moments of a simulation in one picture, from left to right and top to bottom."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from PIL import Image, ImageDraw, ImageFont

from irsim.graphics.encoding.pixels import to_image
from irsim.graphics.figure.figure import SceneFigure
from irsim.graphics.figure.layers import opaque_colors
from irsim.graphics.scene.scene import Region, Scene
from irsim.graphics.scene.style import Palette
from irsim.graphics.scene.theme import Theme
from irsim.objects.views import views
from irsim.rendering.modern.frame import grid_step
from irsim.rendering.modern.layout import fit
from irsim.rendering.modern.still import StillPicture
from irsim.rendering.modern.style import Request, name_of
from irsim.rendering.readability import can_move
from irsim.rendering.snapshot import Extra, legible_scene, png_of

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["Strip", "tiling"]

_GAP_PX = 6
_LINE_HEIGHT_PX = 17
_FONT_SIZE_PX = 13
_HEAD_PX = 20
"""Height of the line above all tiles, in the style `modern`."""
MIN_DPI = 68.0
MAX_DPI = 100.0
_PX_PER_DPI = 4.0
"""Pixels of the longer side of a tile per dot per inch, so that small tiles have smaller text."""
MAX_OBSTACLE_NAMES = 12
"""Obstacles are named only if there are at most this many."""
_LEGENDS = ("contact between two steps", "between two steps", "contact")
"""Meaning of the diamonds, beside the time of the first tile that has one; the longest that fits."""
_DIAMOND_PX = 4
_FRAME_COLOR = "#868e96"
_TEXT_COLOR = "black"


class Strip:
    """Several moments as tiles of one picture.

    Args:
        count: Number of moments that will be added.
        size_px: Largest length of the longer side of the picture [px].
        region: x_min, y_min, x_max, y_max [m] of the part to show; default: the whole world.
        overrides: Object plot keys.
    """

    def __init__(
        self,
        count: int,
        size_px: int,
        *,
        region: Sequence[float] | None = None,
        overrides: Mapping[str, Any] | None = None,
    ) -> None:
        self._count, self._size = count, size_px
        self._region, self._overrides = region, overrides
        self._tiles: list[tuple[str, Image.Image]] = []
        self._colors: dict[tuple[int, int, int], None] = {}
        self._columns, self._tile = 1, (1, 1)
        self._title = ""
        self._first_contact: int | None = None
        self._theme: Theme | None = None
        self._word, self._step = "", 1.0

    def add(self, simulation: Simulation, extra: Extra | None = None) -> None:
        """Add a tile that shows the present moment."""
        if simulation.scenario.world.plot.style == "modern":
            self._add_modern(simulation, extra)
            return
        scene, pictures = legible_scene(simulation, region=self._region, overrides=self._overrides, extra=extra)
        if not self._tiles:
            x0, x1, y0, y1 = scene.extent
            options = simulation.scenario.world.plot
            self._title = options.title if options.title and options.show_title else ""
            side = self._size - (_LINE_HEIGHT_PX if self._title else 0)
            self._columns, self._tile = tiling(self._count, x1 - x0, y1 - y0, side)
        _simplify(scene, simulation, first=not self._tiles)
        if self._first_contact is None and _marks_contact(scene):
            self._first_contact = len(self._tiles)
        dpi = min(MAX_DPI, max(MIN_DPI, max(self._tile) / _PX_PER_DPI))
        figure = SceneFigure(self._tile, dpi, axis=False, tight=False, pictures=pictures, halo=True)
        figure.figure.subplots_adjust(left=0, right=1, bottom=0, top=1)
        figure.show(scene, None)
        pixels, _ = figure.pixels(tight=False)
        self._colors.update(dict.fromkeys(opaque_colors(scene)))
        self._tiles.append((f"{scene.time:.2f} s  step {int(simulation.count[0])}", to_image(pixels)))

    def _add_modern(self, simulation: Simulation, extra: Extra | None) -> None:
        picture = StillPicture(simulation, region=self._region, overrides=self._overrides, extra=extra)
        x0, x1, y0, y1 = picture.world_shown
        if not self._tiles:
            side = self._size - _LINE_HEIGHT_PX
            self._theme, self._title = picture.theme, name_of(simulation)
            self._columns, self._tile = tiling(self._count, x1 - x0, y1 - y0, side)
            self._tile = self._tile[0], self._tile[1] + _LINE_HEIGHT_PX
        layout = fit(picture.world_shown, max(self._tile), box=self._tile, strip=True)
        request = Request(overrides=self._overrides or {}, said=self._word, names=not self._tiles)
        pixels, colors = picture.draw(layout, request)
        self._word = picture.word
        self._colors.update(dict.fromkeys(colors))
        self._tiles.append(("", to_image(pixels).convert("RGB")))
        self._tile = layout.size
        self._step = grid_step(layout)

    def _modern_png(self, theme: Theme) -> bytes:
        (width, height), columns = self._tile, self._columns
        rows = math.ceil(len(self._tiles) / columns)
        size = columns * (width + _GAP_PX) + _GAP_PX, _HEAD_PX + rows * (height + _GAP_PX)
        sheet = Image.new("RGB", size, theme.page)
        draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(_FONT_SIZE_PX)
        draw.text((2 * _GAP_PX, _HEAD_PX - 6), self._title, fill=theme.ink, font=font, anchor="ls")
        note = f"grid {self._step:g} m"
        if draw.textlength(self._title + note, font=font) + 6 * _GAP_PX < sheet.width:
            draw.text((sheet.width - 2 * _GAP_PX, _HEAD_PX - 6), note, fill=theme.muted, font=font, anchor="rs")
        for number, (_, image) in enumerate(self._tiles):
            left = _GAP_PX + number % columns * (width + _GAP_PX)
            sheet.paste(image, (left, _HEAD_PX + number // columns * (height + _GAP_PX)))
        return png_of(sheet, list(self._colors))

    def png(self) -> bytes:
        """Return the picture as a PNG file with few colours."""
        if self._theme is not None:
            return self._modern_png(self._theme)
        (width, height), columns = self._tile, self._columns
        rows = math.ceil(len(self._tiles) / columns)
        step_x, step_y = width + _GAP_PX, height + _LINE_HEIGHT_PX + _GAP_PX
        head = _LINE_HEIGHT_PX if self._title else 0
        sheet = Image.new("RGB", (columns * step_x + _GAP_PX, head + rows * step_y + _GAP_PX), "white")
        draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(_FONT_SIZE_PX)
        draw.text((sheet.width / 2, head), self._title, fill=_TEXT_COLOR, font=font, anchor="ms")
        for number, (text, image) in enumerate(self._tiles):
            left = _GAP_PX + number % columns * step_x
            top = head + _GAP_PX + number // columns * step_y + _LINE_HEIGHT_PX
            sheet.paste(image, (left, top))
            draw.rectangle((left - 1, top - 1, left + width, top + height), outline=_FRAME_COLOR)
            short = text if draw.textlength(text, font=font) <= width else text.partition("  ")[0]
            draw.text((left, top - 3), short, fill=_TEXT_COLOR, font=font, anchor="ls")
            if number == self._first_contact:
                _add_legend(draw, font, left + draw.textlength(short, font=font), (left + width, top - 3))
        return png_of(sheet, list(self._colors))


def _marks_contact(scene: Scene) -> bool:
    """Whether a contact between two steps is marked within what a scene shows."""
    x0, x1, y0, y1 = scene.extent
    shapes = [mark.geometry for mark in scene.marks if mark.object < 0 and mark.part == "contact"]
    places = [shape.rings[0].mean(axis=0) for shape in shapes if isinstance(shape, Region)]
    return any(x0 <= x <= x1 and y0 <= y <= y1 for x, y in places)


def _add_legend(
    draw: ImageDraw.ImageDraw,
    font: ImageFont.FreeTypeFont | ImageFont.ImageFont,
    begin: float,
    end: tuple[float, float],
) -> None:
    """Say what the diamonds mean, right-aligned at ``end``, and not before ``begin`` [px]."""
    right, base = end
    for text in _LEGENDS:
        middle = right - draw.textlength(text, font=font) - 2 * _DIAMOND_PX
        if middle - 3 * _DIAMOND_PX < begin:
            continue
        draw.text((right, base), text, fill=_TEXT_COLOR, font=font, anchor="rs")
        up, side = 1.2 * _DIAMOND_PX, _DIAMOND_PX
        y = base - _DIAMOND_PX
        corners = [(middle, y - up), (middle + side, y), (middle, y + up), (middle - side, y)]
        draw.line([*corners, corners[0]], fill=Palette().contact, width=2)
        return


def _simplify(scene: Scene, simulation: Simulation, *, first: bool) -> None:
    """Remove what a small tile has no space for.

    Goals of obstacles have no labels; the first tile names the obstacles, if they are few, and has the labels that
    belong to no object. Objects that do not move have neither path nor goal.
    """
    movers = {view.id for view in views(simulation) if view.role == "robot" or can_move(view)}
    robots = {view.id for view in views(simulation) if view.role == "robot"}
    named = sum(label.object >= 0 and label.object not in robots and label.part == "name" for label in scene.labels)
    names_obstacles = first and named <= MAX_OBSTACLE_NAMES
    scene.marks = [mark for mark in scene.marks if mark.object in movers or mark.part not in ("trajectory", "goal")]
    scene.labels = [
        label
        for label in scene.labels
        if label.object in robots or (first and label.object < 0) or (names_obstacles and label.part == "name")
    ]


def tiling(count: int, width: float, height: float, side: int) -> tuple[int, tuple[int, int]]:
    """Find the number of columns with which tiles are largest within a square.

    Args:
        count: Number of tiles.
        width: Width of the area that each tile shows [m].
        height: Height of that area [m].
        side: Side of the square [px].

    Returns:
        Number of columns, and width and height of a tile [px].
    """
    best, scale = 1, 0.0
    for columns in range(1, count + 1):
        rows = math.ceil(count / columns)
        tile_width = (side - _GAP_PX) / columns - _GAP_PX
        tile_height = (side - _GAP_PX) / rows - _GAP_PX - _LINE_HEIGHT_PX
        fitting_scale = min(tile_width / width, tile_height / height)
        if fitting_scale > scale * (1 + 1e-9):
            best, scale = columns, fitting_scale
    return best, (max(1, int(scale * width)), max(1, int(scale * height)))
