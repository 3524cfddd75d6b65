"""GIF written frame by frame: one palette for as long as it serves, and only the pixels that changed."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray
from PIL import GifImagePlugin, Image, ImageChops

from irsim.graphics.encoding.pixels import Pixels, changed_box, differing, to_image

__all__ = ["GifWriter", "reduce_colors"]

_COLORS = 255
_TRANSPARENT = 255
_KEEP = 1 << 2
"""Disposal: the next frame is drawn over this one."""
_TABLE_256 = 7
_CLOSE = 8
"""Colours nearer than this in all channels count as one (of 256 levels)."""
_FAR = 32
"""A pixel that misses its colour by more than this in a channel counts as wrong."""
_WRONG_SHARE = 0.0005
_MAX_HINTS = 64
_SAMPLED = 100_000
"""Of larger pictures every fourth pixel is enough to choose colours (time and memory)."""
_DESCRIPTOR = 10


class GifWriter:
    """Streams frames into a GIF; nothing but the last frame is held in memory.

    Args:
        file: Open for writing and seeking, empty.
        duration: Of a frame [s].
        loop: Times to repeat; 0 for ever, None to play once.
        colors: (r, g, b) that must come out exactly, 0..255.
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

    def add(self, pixels: Pixels) -> None:
        """Append a frame; all have the size of the first."""
        if self._last is None:
            image = to_image(pixels)
            self.__palette(image)
            self._start(pixels.shape[1], pixels.shape[0])
            self._local = False
            self._frame(image, (0, 0, *image.size), None)
        else:
            changed = differing(pixels, self._last)
            box = changed_box(changed)
            left, top, right, bottom = box
            part = np.ascontiguousarray(pixels[top:bottom, left:right])
            self._frame(to_image(part), box, changed[top:bottom, left:right])
        self._last = pixels
        self.frames += 1

    def close(self, last_duration: float) -> None:
        """Finish the file.

        Args:
            last_duration: Of the last frame [s].
        """
        self._file.write(b";")
        self._file.seek(self._delay_at)
        self._file.write(_delay(last_duration))

    def _start(self, width: int, height: int) -> None:
        flags = 0x80 | 0x70 | _TABLE_256
        self._file.write(b"GIF89a" + struct.pack("<HHBBB", width, height, flags, 0, 0) + _table(self._palette))
        if self._loop is not None:
            self._file.write(b"!\xff\x0bNETSCAPE2.0\x03\x01" + struct.pack("<H", self._loop) + b"\x00")

    def __palette(self, image: Image.Image) -> None:
        """Colours for this frame and those that look like it."""
        self._palette = _palette(image, self._hints)
        indexed = image.quantize(palette=self._palette, dither=Image.Dither.NONE)
        self._accepted = 2 * _wrong(image, indexed)

    def _frame(self, image: Image.Image, box: tuple[int, int, int, int], changed: NDArray[np.bool_] | None) -> None:
        indexed = image.quantize(palette=self._palette, dither=Image.Dither.NONE)
        if changed is not None and _wrong(image, indexed) > self._accepted + _WRONG_SHARE * changed.size + 1:
            self.__palette(image)
            self._local = True
            indexed = image.quantize(palette=self._palette, dither=Image.Dither.NONE)
        if changed is not None:
            indices = np.array(indexed)
            indices[~changed] = _TRANSPARENT
            indexed = Image.fromarray(indices)
        flags = _KEEP | (changed is not None)
        self._file.write(b"!\xf9\x04" + bytes([flags]))
        self._delay_at = self._file.tell()
        self._file.write(_delay(self._duration) + bytes([_TRANSPARENT, 0]))
        left, top, right, bottom = box
        local = 0x80 | _TABLE_256 if self._local else 0
        self._file.write(b"," + struct.pack("<HHHHB", left, top, right - left, bottom - top, local))
        if self._local:
            self._file.write(_table(self._palette))
        self._file.write(b"".join(GifImagePlugin.getdata(indexed))[_DESCRIPTOR:])


def _delay(seconds: float) -> bytes:
    return struct.pack("<H", min(0xFFFF, round(seconds * 100)))


def _table(palette: Image.Image) -> bytes:
    return bytes(palette.getpalette() or []).ljust(3 * 256, b"\0")[: 3 * 256]


def reduce_colors(image: Image.Image, hints: Sequence[tuple[int, int, int]], most: int) -> Image.Image:
    """An image of at most so many colours; pixels of those asked for keep them exactly."""
    palette = _palette(image, hints, most)
    indexed = np.array(image.quantize(palette=palette, dither=Image.Dither.NONE))
    levels = np.asarray(image).astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], dtype=np.uint32)
    for index, (r, g, b) in enumerate(list(dict.fromkeys(hints))[:_MAX_HINTS]):
        indexed[levels == (r << 16) + (g << 8) + b] = index
    reduced = Image.fromarray(indexed)
    reduced.putpalette(palette.getpalette() or [])
    return reduced


def _palette(image: Image.Image, hints: Sequence[tuple[int, int, int]], most: int = _COLORS) -> Image.Image:
    """At most so many colours: those asked for, then the image's own that differ from them."""
    sample = image
    if image.width * image.height > _SAMPLED:
        sample = image.resize((image.width // 2, image.height // 2), Image.Resampling.NEAREST)
    found = sample.quantize(most, method=Image.Quantize.MEDIANCUT).getpalette() or []
    own = [(found[i], found[i + 1], found[i + 2]) for i in range(0, len(found), 3)]
    chosen: list[tuple[int, int, int]] = list(dict.fromkeys(hints))[:_MAX_HINTS]
    fixed = np.array(chosen or [(0, 0, 0)], dtype=np.int16)
    for color in own:
        near = (np.abs(fixed - np.array(color, dtype=np.int16)) < _CLOSE).all(axis=1).any() if chosen else False
        if not near and len(chosen) < most:
            chosen.append(color)
    flat = [level for color in chosen for level in color]
    flat += flat[:3] * (most - len(chosen))
    palette = Image.new("P", (1, 1))
    palette.putpalette(flat)
    return palette


def _wrong(image: Image.Image, indexed: Image.Image) -> int:
    """Pixels whose colour is far from the one wanted."""
    bands = ImageChops.difference(image, indexed.convert("RGB")).split()
    worst = ImageChops.lighter(ImageChops.lighter(bands[0], bands[1]), bands[2])
    return sum(worst.histogram()[_FAR + 1 :])
