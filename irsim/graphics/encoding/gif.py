"""Writes GIF files frame by frame: a new palette only when the colours change, and only the pixels that changed."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import BinaryIO

import numpy as np
from PIL import Image

from irsim import _core as core
from irsim.graphics.encoding.pixels import Pixels, to_image

__all__ = ["GifWriter", "reduce_colors"]

Box = tuple[int, int, int, int]
"""Left, top, right and bottom of a part of a frame [px]."""
MAX_COLORS = 255
"""Number of colours of a palette; the remaining index means transparent."""
_TRANSPARENT = 255
"""Index that leaves a pixel as it was in the previous frame."""
_KEEP_PREVIOUS = 1 << 2
"""Disposal method: the next frame is drawn over this one."""
_TABLE_256 = 7
"""Code for a table of 256 colours."""
_SIMILAR_LEVELS = 4
"""Two colours that differ by fewer levels (of 256) in every channel share an entry of the palette."""
MAX_WRONG_SHARE = 0.0005
"""Share of additional wrong pixels in a frame, those far from their colour, above which a new palette is made."""
MAX_HINTS = 64
"""Number of given colours that a palette takes over."""
_PAPER_AND_INK = {(255, 255, 255), (0, 0, 0)}
MAX_SAMPLED_PIXELS = 100_000
"""Colours of larger pictures are chosen from every fourth pixel, which saves time and memory."""


class GifWriter:
    """Streams frames into a GIF; only the last frame is held in memory.

    Args:
        file: Empty file, open for writing and seeking.
        duration: Duration of a frame [s].
        loop: Number of repetitions; 0 repeats without end, None plays once.
        colors: (r, g, b) colours, 0..255, that must be reproduced exactly.
    """

    def __init__(
        self,
        file: BinaryIO,
        *,
        duration: float = 0.1,
        loop: int | None = 0,
        colors: Sequence[tuple[int, int, int]] = (),
    ) -> None:
        self._file = file
        self._duration, self._loop, self._hints = duration, loop, list(colors)
        self._last: Pixels | None = None
        self._delay_at = 0
        self.frames = 0

    def add(self, pixels: Pixels, changed: Sequence[Box] | None = None) -> None:
        """Append a frame, whose memory may change afterwards; all frames must have the size of the first.

        Args:
            pixels: The frame.
            changed: Boxes outside of which it is as the last one; None if that is not known.
        """
        boxes = None if changed is None else list(changed)
        if self._last is None:
            self._choose_palette(pixels)
            self._start(pixels.shape[1], pixels.shape[0])
            self._local = False
            self._frame(pixels, (0, 0, pixels.shape[1], pixels.shape[0]), None)
            self._last = pixels.copy()
        else:
            box = core.changed_box(self._last, pixels, boxes) or (0, 0, 1, 1)
            self._frame(pixels, box, boxes)
            core.copy_boxes(pixels, self._last, [box] if boxes is None else boxes)
        self.frames += 1

    def close(self, last_duration: float) -> None:
        """Finish the file.

        Args:
            last_duration: Duration of the last frame [s].
        """
        self._file.write(b";")
        self._file.seek(self._delay_at)
        self._file.write(_delay(last_duration))

    def _start(self, width: int, height: int) -> None:
        flags = 0x80 | 0x70 | _TABLE_256
        self._file.write(b"GIF89a" + struct.pack("<HHBBB", width, height, flags, 0, 0) + self._table)
        if self._loop is not None:
            self._file.write(b"!\xff\x0bNETSCAPE2.0\x03\x01" + struct.pack("<H", self._loop) + b"\x00")

    def _choose_palette(self, pixels: Pixels) -> None:
        """Choose the palette for this frame and the following ones that have similar colours."""
        self._table = bytes(_palette(to_image(pixels), self._hints).getpalette() or []).ljust(3 * 256, b"\0")[: 3 * 256]
        levels = list(self._table[: 3 * MAX_COLORS])
        self._palette = core.Palette(list(dict.fromkeys(zip(levels[::3], levels[1::3], levels[2::3], strict=True))))
        self._accepted: int | None = None

    def _frame(self, pixels: Pixels, box: Box, boxes: list[Box] | None) -> None:
        before = self._last
        wrong, data = self._palette.encode(pixels, before, box, boxes, _TRANSPARENT)
        left, top, right, bottom = box
        if self._accepted is None:
            self._accepted = 2 * wrong
        elif wrong > self._accepted + MAX_WRONG_SHARE * (right - left) * (bottom - top) + 1:
            self._choose_palette(pixels[top:bottom, left:right])
            self._local = True
            wrong, data = self._palette.encode(pixels, before, box, boxes, _TRANSPARENT)
            self._accepted = 2 * wrong
        flags = _KEEP_PREVIOUS | (before is not None)
        self._file.write(b"!\xf9\x04" + bytes([flags]))
        self._delay_at = self._file.tell()
        self._file.write(_delay(self._duration) + bytes([_TRANSPARENT, 0]))
        local = 0x80 | _TABLE_256 if self._local else 0
        self._file.write(b"," + struct.pack("<HHHHB", left, top, right - left, bottom - top, local))
        if self._local:
            self._file.write(self._table)
        self._file.write(data)


def _delay(seconds: float) -> bytes:
    return struct.pack("<H", min(0xFFFF, round(seconds * 100)))


def reduce_colors(image: Image.Image, hints: Sequence[tuple[int, int, int]], max_colors: int) -> Image.Image:
    """Reduce an image to at most ``max_colors`` colours; pixels that have a colour of ``hints`` keep it exactly."""
    palette = _palette(image, hints, max_colors)
    indexed = np.array(image.quantize(palette=palette, dither=Image.Dither.NONE))
    levels = np.asarray(image).astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], dtype=np.uint32)
    for index, (r, g, b) in enumerate(list(dict.fromkeys(hints))[:MAX_HINTS]):
        indexed[levels == (r << 16) + (g << 8) + b] = index
    reduced = Image.fromarray(indexed)
    reduced.putpalette(palette.getpalette() or [])
    return reduced


def _palette(image: Image.Image, hints: Sequence[tuple[int, int, int]], max_colors: int = MAX_COLORS) -> Image.Image:
    """Choose at most ``max_colors`` colours: first the hints, then colours of the image that differ from them."""
    sample = image
    if image.width * image.height > MAX_SAMPLED_PIXELS:
        sample = image.resize((image.width // 2, image.height // 2), Image.Resampling.NEAREST)
    words = np.asarray(sample.convert("RGBA")).reshape(-1, 4).view(np.uint32)[:, 0]
    for red, green, blue in _PAPER_AND_INK & set(hints):  # most of a drawing; the other colours are chosen without them
        words = words[words != np.array([red, green, blue, 255], np.uint8).view(np.uint32)[0]]
    rest = words if words.size else np.zeros(1, np.uint32)
    other = Image.frombuffer("RGBA", (rest.size, 1), rest.tobytes(), "raw", "RGBA", 0, 1).convert("RGB")
    result = other.quantize(max_colors, method=Image.Quantize.MEDIANCUT).getpalette() or []
    own = [(result[i], result[i + 1], result[i + 2]) for i in range(0, len(result), 3)]
    chosen: list[tuple[int, int, int]] = list(dict.fromkeys(hints))[:MAX_HINTS]
    for color in own:
        distances = np.abs(np.array(chosen, dtype=np.int16).reshape(-1, 3) - np.array(color, dtype=np.int16))
        if not (distances < _SIMILAR_LEVELS).all(axis=1).any() and len(chosen) < max_colors:
            chosen.append(color)
    chosen = chosen or [(0, 0, 0)]
    flat = [level for color in chosen for level in color]
    flat += flat[:3] * (max_colors - len(chosen))
    palette = Image.new("P", (1, 1))
    palette.putpalette(flat)
    return palette
