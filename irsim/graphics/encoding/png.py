"""PNG and animated PNG, written straight from pixels (flat drawings need no filters, and little effort)."""

from __future__ import annotations

import struct
import zlib
from typing import BinaryIO

import numpy as np
from isal import isal_zlib
from PIL import Image

from irsim.graphics.encoding.pixels import Pixels, changed_box, differing

__all__ = ["ApngWriter", "png_bytes"]

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_LEVEL = 2
_TRUECOLOR = 2
_DELAY_UNIT = 1000
_FORGET, _REPLACE = 0, 0
_NO_FILTER = b"\0"


def png_bytes(pixels: Pixels, dpi: float | None = None) -> bytes:
    """A PNG file.

    Args:
        pixels: The picture.
        dpi: Pixels per inch to note in the file.
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
        file: Open for writing and seeking, empty.
        duration: Of a frame [s].
        loop: Times to play; 0 for ever.
    """

    def __init__(self, file: BinaryIO, *, duration: float = 0.1, loop: int = 0) -> None:
        self._file = file
        self._duration, self._loop = duration, loop
        self._last: Pixels | None = None
        self._sequence = 0
        self.frames = 0

    def add(self, pixels: Pixels) -> None:
        """Append a frame; all have the size of the first."""
        if self._last is None:
            height, width = pixels.shape[:2]
            self._file.write(_SIGNATURE + _header(width, height))
            self._count_at = self._file.tell()
            self._file.write(_chunk(b"acTL", struct.pack(">II", 1, self._loop)))
            left, top, part = 0, 0, pixels
        else:
            left, top, part = _changed(self._last, pixels)
        self._control(left, top, part, self._duration)
        data = _compress(part)
        if self._last is None:
            self._file.write(_chunk(b"IDAT", data))
        else:
            self._file.write(_chunk(b"fdAT", struct.pack(">I", self._next()) + data))
        self._last = pixels
        self.frames += 1

    def close(self, last_duration: float) -> None:
        """Finish the file.

        Args:
            last_duration: Of the last frame [s].
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
        delay = round(duration * _DELAY_UNIT)
        fields = sequence, width, height, left, top, delay, _DELAY_UNIT, _FORGET, _REPLACE
        return _chunk(b"fcTL", struct.pack(">IIIIIHHBB", *fields))

    def _next(self) -> int:
        self._sequence += 1
        return self._sequence - 1


def _changed(before: Pixels, after: Pixels) -> tuple[int, int, Pixels]:
    left, top, right, bottom = changed_box(differing(before, after))
    return left, top, after[top:bottom, left:right]


def _header(width: int, height: int) -> bytes:
    return _chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, _TRUECOLOR, 0, 0, 0))


def _compress(pixels: Pixels) -> bytes:
    height, width = pixels.shape[:2]
    image = Image.frombuffer("RGBA", (width, height), np.ascontiguousarray(pixels), "raw", "RGBA", 0, 1)
    # A stride of one byte more than a row has puts a zero, the filter of the next row, behind each row.
    rows = image.tobytes("raw", "RGB", 3 * width + 1, 1)
    compressor = isal_zlib.compressobj(_LEVEL)
    return b"".join([compressor.compress(_NO_FILTER), compressor.compress(memoryview(rows)[:-1]), compressor.flush()])


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
