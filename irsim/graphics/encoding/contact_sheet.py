"""Writes a contact sheet: many small pictures, each with a line of text below."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from irsim.common.files import replacing

__all__ = ["contact_sheet"]

_LINE_HEIGHT_PX = 22
_GAP_PX = 12


def contact_sheet(
    pictures: Iterable[tuple[str, bytes]], path: str | Path, *, columns: int = 5, size: int = 320
) -> Path:
    """Write a contact sheet.

    Args:
        pictures: Pairs of a line of text and a PNG file.
        path: File to write; its suffix chooses the format.
        columns: Number of pictures in a row.
        size: Side of the square that each picture is fitted into [px].

    Returns:
        Path of the file.
    """
    cells: Sequence[tuple[str, bytes]] = list(pictures)
    rows = -(-len(cells) // columns) or 1
    step = size + _GAP_PX
    sheet_size = columns * step + _GAP_PX, rows * (step + _LINE_HEIGHT_PX) + _GAP_PX
    sheet = Image.new("RGB", sheet_size, "white")
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(15)
    for number, (text, png) in enumerate(cells):
        left = _GAP_PX + (number % columns) * step
        top = _GAP_PX + (number // columns) * (step + _LINE_HEIGHT_PX)
        with Image.open(io.BytesIO(png)) as opened:
            image = opened.convert("RGB")
        image.thumbnail((size, size))
        sheet.paste(image, (left + (size - image.width) // 2, top + (size - image.height) // 2))
        draw.text((left + 4, top + size), text, fill="black", font=font)
    target = Path(path)
    with replacing(target) as temporary:
        sheet.save(temporary, format=Image.registered_extensions().get(target.suffix.lower(), "PNG"))
    return target
