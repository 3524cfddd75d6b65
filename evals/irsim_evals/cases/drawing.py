"""Drawings that a case hands out: floor plans as a picture, drawn from numbers so that a fresh instance has its own."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal

from PIL import Image, ImageDraw, ImageFont
from pydantic import BaseModel, ConfigDict, Field, model_validator

__all__ = ["PICTURES", "Drawing", "Item", "Record", "draw", "stand_ins"]

PICTURES = {".png": "PNG", ".jpg": "JPEG", ".jpeg": "JPEG", ".bmp": "BMP", ".pgm": "PPM"}
"""Ending of a picture → its format."""

_MARGIN = 40
"""Width of the white margin round the plan, which holds the labels of the axes [px]."""
Coordinate = Annotated[float, Field(allow_inf_nan=False, ge=-1e4, le=1e4)]
Extent = Annotated[float, Field(gt=0, le=1e4)]
_MAX_PIXELS = 5e7
_GRID = (222, 222, 222)


class Record(BaseModel):
    """A part of a case file."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)


class Item(Record):
    """One thing in a drawing (m; x to the right, y up)."""

    kind: Literal["box", "disc", "line", "text", "arrow"]
    at: Annotated[list[Coordinate], Field(max_length=4)]
    """A box: x0, y0, x1, y1. A disc: x, y, radius. A line or an arrow: x0, y0, x1, y1. A text: its middle."""
    color: str = "black"
    """Name of a color or ``#rrggbb``."""
    text: str = ""
    """Words of a text."""
    width: Annotated[int, Field(ge=0, le=1000)] = 3
    """Width of a line [px]."""


class Drawing(Record):
    """A plan drawn to scale."""

    size: tuple[Extent, Extent]
    """Width and height of what is shown [m]."""
    scale: Annotated[int, Field(ge=1, le=1000)] = 40
    """Pixels for each metre."""
    grid: Annotated[float, Field(ge=0.01, le=1e4)] | None = None
    """Distance of grid lines, with numbers at the edges [m]."""
    items: list[Item]
    """The things in it, the first at the bottom."""

    @model_validator(mode="after")
    def _of_a_size_that_is_looked_at(self) -> Drawing:
        pixels = self.size[0] * self.size[1] * self.scale**2
        if pixels > _MAX_PIXELS:
            raise ValueError(f"the picture would have {pixels:.3g} pixels, at most {_MAX_PIXELS:g}; reduce `scale`")
        return self


def draw(drawing: Drawing) -> bytes:
    """The drawing as a PNG file."""
    scale, (width, height) = drawing.scale, drawing.size
    pixels = round(width * scale) + 2 * _MARGIN, round(height * scale) + 2 * _MARGIN
    image = Image.new("RGB", pixels, "white")
    pen = ImageDraw.Draw(image)
    font = ImageFont.load_default(16)

    def spot(x: float, y: float) -> tuple[int, int]:
        return round(_MARGIN + x * scale), round(pixels[1] - _MARGIN - y * scale)

    if drawing.grid is not None:
        for k in range(round(width / drawing.grid) + 1):
            x = k * drawing.grid
            pen.line([spot(x, 0), spot(x, height)], fill=_GRID)
            pen.text((spot(x, 0)[0], pixels[1] - _MARGIN + 12), f"{x:g}", fill="gray", font=font, anchor="mm")
        for k in range(round(height / drawing.grid) + 1):
            y = k * drawing.grid
            pen.line([spot(0, y), spot(width, y)], fill=_GRID)
            pen.text((_MARGIN - 16, spot(0, y)[1]), f"{y:g}", fill="gray", font=font, anchor="mm")
    for item in drawing.items:
        if item.kind == "box":
            x0, y0, x1, y1 = item.at
            pen.rectangle([spot(x0, y1), spot(x1, y0)], fill=item.color)
        elif item.kind == "disc":
            x, y, radius = item.at
            pen.ellipse([spot(x - radius, y + radius), spot(x + radius, y - radius)], fill=item.color)
        elif item.kind == "text":
            pen.text(spot(item.at[0], item.at[1]), item.text, fill=item.color, font=font, anchor="mm")
        else:
            x0, y0, x1, y1 = item.at
            pen.line([spot(x0, y0), spot(x1, y1)], fill=item.color, width=item.width)
            if item.kind == "arrow":
                end = spot(x1, y1)
                pen.ellipse([end[0] - 5, end[1] - 5, end[0] + 5, end[1] + 5], fill=item.color)
    return _saved(image, "PNG")


def stand_ins(names: Sequence[str]) -> dict[str, bytes]:
    """Pictures of nothing in place of maps that are not there: name → content of the file."""
    return {name: _saved(Image.new("L", (100, 100), 255), PICTURES[Path(name).suffix.lower()]) for name in names}


def _saved(image: Image.Image, kind: str) -> bytes:
    file = io.BytesIO()
    image.save(file, format=kind)
    return file.getvalue()
