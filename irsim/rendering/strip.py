"""Several moments of a simulation as one picture, from left to right and top to bottom."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from PIL import Image, ImageDraw, ImageFont

from irsim.graphics.encoding.pixels import to_image
from irsim.graphics.figure.figure import SceneFigure
from irsim.graphics.figure.layers import opaque_colors
from irsim.graphics.scene.scene import Scene
from irsim.objects.views import views
from irsim.rendering.snapshot import Extra, legible_scene, png_of

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["Strip", "tiling"]

_GAP = 6
_LINE = 17
_FONT = 13
_DPI = 68.0, 100.0
_PER_DPI = 4.0
"""A tile has about so many pixels for each dot per inch, so that small ones have smaller text."""
_MOST_NAMES = 12
_FRAME, _INK = "#868e96", "black"


class Strip:
    """A sheet of moments.

    Args:
        count: How many there will be.
        size_px: Longer side of the picture at most.
        region: x_min, y_min, x_max, y_max [m] of the part to show; default: the world.
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

    def add(self, simulation: Simulation, extra: Extra | None = None) -> None:
        """Draw the present moment."""
        scene, pictures = legible_scene(simulation, region=self._region, overrides=self._overrides, extra=extra)
        if not self._tiles:
            x0, x1, y0, y1 = scene.extent
            self._columns, self._tile = tiling(self._count, x1 - x0, y1 - y0, self._size)
        _simplify(scene, simulation, first=not self._tiles)
        dpi = min(_DPI[1], max(_DPI[0], max(self._tile) / _PER_DPI))
        figure = SceneFigure(self._tile, dpi, axis=False, tight=False, pictures=pictures, halo=True)
        figure.figure.subplots_adjust(left=0, right=1, bottom=0, top=1)
        figure.show(scene, None)
        pixels, _ = figure.pixels(tight=False)
        self._colors.update(dict.fromkeys(opaque_colors(scene)))
        self._tiles.append((f"{scene.time:.2f} s  step {int(simulation.count[0])}", to_image(pixels)))

    def png(self) -> bytes:
        """The sheet as a PNG of few colours."""
        (width, height), columns = self._tile, self._columns
        rows = math.ceil(len(self._tiles) / columns)
        across, down = width + _GAP, height + _LINE + _GAP
        sheet = Image.new("RGB", (columns * across + _GAP, rows * down + _GAP), "white")
        draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(_FONT)
        for number, (text, image) in enumerate(self._tiles):
            left, top = _GAP + number % columns * across, _GAP + number // columns * down + _LINE
            sheet.paste(image, (left, top))
            draw.rectangle((left - 1, top - 1, left + width, top + height), outline=_FRAME)
            short = text if draw.textlength(text, font=font) <= width else text.partition("  ")[0]
            draw.text((left, top - 3), short, fill=_INK, font=font, anchor="ls")
        return png_of(sheet, list(self._colors))


def _simplify(scene: Scene, simulation: Simulation, *, first: bool) -> None:
    """Leave out what a small picture has no room for: paths of obstacles, their goals, and names that were told."""
    robots = {view.id for view in views(simulation) if view.role == "robot"}
    named = sum(label.object >= 0 and label.object not in robots and label.part == "name" for label in scene.labels)
    told = first and named <= _MOST_NAMES
    scene.marks = [mark for mark in scene.marks if mark.object in robots or mark.part not in ("trajectory", "goal")]
    scene.labels = [
        label
        for label in scene.labels
        if label.object in robots or (first and label.object < 0) or (told and label.part == "name")
    ]


def tiling(count: int, width: float, height: float, side: int) -> tuple[int, tuple[int, int]]:
    """How so many tiles become largest within a square.

    Args:
        count: How many.
        width: Of what each shows [m].
        height: Of that [m].
        side: Of the square [px].

    Returns:
        Columns, and width and height of a tile [px].
    """
    best, scale = 1, 0.0
    for columns in range(1, count + 1):
        rows = math.ceil(count / columns)
        across = (side - _GAP) / columns - _GAP
        down = (side - _GAP) / rows - _GAP - _LINE
        fits = min(across / width, down / height)
        if fits > scale * (1 + 1e-9):
            best, scale = columns, fits
    return best, (max(1, int(scale * width)), max(1, int(scale * height)))
