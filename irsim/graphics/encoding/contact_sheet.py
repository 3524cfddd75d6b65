"""Many small pictures on one sheet, each with a line under it."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from irsim.common.files import replacing

__all__ = ["contact_sheet"]

_LINE = 22
_GAP = 12


def contact_sheet(
    pictures: Iterable[tuple[str, bytes]], path: str | Path, *, columns: int = 5, size: int = 320
) -> Path:
    """Write a sheet.

    Args:
        pictures: Line of text and PNG of each.
        path: File to write; the format is that of its suffix.
        columns: Pictures in a row.
        size: Side of the square that each is fitted into [px].

    Returns:
        The file.
    """
    cells: Sequence[tuple[str, bytes]] = list(pictures)
    rows = -(-len(cells) // columns) or 1
    step = size + _GAP
    sheet = Image.new("RGB", (columns * step + _GAP, rows * (step + _LINE) + _GAP), "white")
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(15)
    for number, (text, png) in enumerate(cells):
        left = _GAP + (number % columns) * step
        top = _GAP + (number // columns) * (step + _LINE)
        with Image.open(io.BytesIO(png)) as opened:
            image = opened.convert("RGB")
        image.thumbnail((size, size))
        sheet.paste(image, (left + (size - image.width) // 2, top + (size - image.height) // 2))
        draw.text((left + 4, top + size), text, fill="black", font=font)
    target = Path(path)
    with replacing(target) as temporary:
        sheet.save(temporary, format=Image.registered_extensions().get(target.suffix.lower(), "PNG"))
    return target
