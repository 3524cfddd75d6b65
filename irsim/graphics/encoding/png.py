"""Writes PNG and animated PNG directly from pixels.

This is faster than Pillow: flat drawings compress well without filters and at a low level of compression.
"""

from __future__ import annotations

import struct
import zlib
from typing import BinaryIO

from isal import isal_zlib

from irsim import _core as core
from irsim.graphics.encoding.pixels import Pixels

__all__ = ["ApngWriter", "png_bytes"]

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_COMPRESSION_LEVEL = 2
_TRUECOLOR = 2
_DELAYS_PER_SECOND = 1000
"""Denominator of the frame delays in the file: they count milliseconds."""
_KEEP_PREVIOUS = 0
"""Disposal method: the next frame is drawn over this one."""
_OVERWRITE = 0
"""Blend method: a frame replaces the pixels below it."""


def png_bytes(pixels: Pixels, dpi: float | None = None) -> bytes:
    """Return the content of a PNG file.

    Args:
        pixels: The picture.
        dpi: Pixels per inch, stored in the file if given.
    """
    height, width = pixels.shape[:2]
    parts = [_SIGNATURE, _header(width, height)]
    if dpi is not None:
        per_metre = round(dpi / 0.0254)
        parts.append(_chunk(b"pHYs", struct.pack(">IIB", per_metre, per_metre, 1)))
    parts += [_chunk(b"IDAT", _compress(pixels)), _chunk(b"IEND", b"")]
    return b"".join(parts)


class ApngWriter:
    """Animated PNG in full colour: each frame after the first stores only the rectangle that changed.

    Args:
        file: Empty file, open for writing and seeking.
        duration: Duration of a frame [s].
        loop: Number of times to play; 0 repeats without end.
    """

    def __init__(self, file: BinaryIO, *, duration: float = 0.1, loop: int = 0) -> None:
        self._file = file
        self._duration, self._loop = duration, loop
        self._last: Pixels | None = None
        self._sequence = 0
        self.frames = 0

    def add(self, pixels: Pixels) -> None:
        """Append a frame; all frames must have the size of the first."""
        if self._last is None:
            height, width = pixels.shape[:2]
            self._file.write(_SIGNATURE + _header(width, height))
            self._count_at = self._file.tell()
            self._file.write(_chunk(b"acTL", struct.pack(">II", 1, self._loop)))
            left, top, part = 0, 0, pixels
        else:
            left, top, part = _changed_part(self._last, pixels)
        self._control(left, top, part, self._duration)
        data = _compress(part)
        if self._last is None:
            self._file.write(_chunk(b"IDAT", data))
        else:
            self._file.write(_chunk(b"fdAT", struct.pack(">I", self._next()) + data))
        self._last = pixels.copy()
        self.frames += 1

    def close(self, last_duration: float) -> None:
        """Finish the file.

        Args:
            last_duration: Duration of the last frame [s].
        """
        self._file.write(_chunk(b"IEND", b""))
        self._file.seek(self._control_at)
        self._file.write(self._control_chunk(*self._control_values, last_duration))
        self._file.seek(self._count_at)
        self._file.write(_chunk(b"acTL", struct.pack(">II", self.frames, self._loop)))

    def _control(self, left: int, top: int, part: Pixels, duration: float) -> None:
        height, width = part.shape[:2]
        self._control_values = self._next(), width, height, left, top
        self._control_at = self._file.tell()
        self._file.write(self._control_chunk(*self._control_values, duration))

    @staticmethod
    def _control_chunk(sequence: int, width: int, height: int, left: int, top: int, duration: float) -> bytes:
        delay = round(duration * _DELAYS_PER_SECOND)
        fields = sequence, width, height, left, top, delay, _DELAYS_PER_SECOND, _KEEP_PREVIOUS, _OVERWRITE
        return _chunk(b"fcTL", struct.pack(">IIIIIHHBB", *fields))

    def _next(self) -> int:
        self._sequence += 1
        return self._sequence - 1


def _changed_part(before: Pixels, after: Pixels) -> tuple[int, int, Pixels]:
    """Return left and top of the rectangle that changed, and its new pixels."""
    left, top, right, bottom = core.changed_box(before, after) or (0, 0, 1, 1)
    return left, top, after[top:bottom, left:right]


def _header(width: int, height: int) -> bytes:
    return _chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, _TRUECOLOR, 0, 0, 0))


def _compress(pixels: Pixels) -> bytes:
    compressor = isal_zlib.compressobj(_COMPRESSION_LEVEL)
    return b"".join([compressor.compress(core.rgb_rows(pixels)), compressor.flush()])


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
