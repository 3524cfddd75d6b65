"""Pictures from outside: kinds without programs, with checksums where there are some."""

from __future__ import annotations

import struct
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from isal.isal_zlib import crc32
from PIL import Image

from irsim.common.records import ContentError

__all__ = ["opened_picture"]

_FORMATS = ("PNG", "PPM", "TIFF", "JPEG", "BMP", "GIF", "WEBP", "TGA", "PCX", "ICO", "JPEG2000")
"""Pictures without programs and without references to other files."""
_BROKEN = (OSError, ValueError, SyntaxError, EOFError, Image.DecompressionBombError, ArithmeticError, LookupError,
           TypeError, AttributeError, MemoryError, RuntimeError, struct.error)  # fmt: skip
"""Exceptions of Pillow on broken files."""

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_BLOCK = 1 << 20
_MAX_CHUNK_BYTES = 2**31 - 1


@contextmanager
def opened_picture(file: Path) -> Iterator[Image.Image]:
    """A picture, whose pixels are read within the context.

    Raises:
        FileNotFoundError: There is no such file.
        NotADirectoryError: A folder of its path is a file.
        ContentError: It cannot be read, also later within the context.
    """
    try:
        _check_png(file)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Pillow's own limit is lower than ours, and it warns of odd remarks
            with Image.open(file, formats=_FORMATS) as image:
                yield image
    except (FileNotFoundError, NotADirectoryError):
        raise
    except _BROKEN as error:
        lines = str(getattr(error, "strerror", None) or error).splitlines()
        raise ContentError(lines[0] if lines else type(error).__name__) from None


def _check_png(file: Path) -> None:
    """Check the parts of a PNG picture, as libraries leave out those with pixels; a file of another kind passes."""
    with file.open("rb") as stream:
        if stream.read(len(_SIGNATURE)) != _SIGNATURE:
            return
        while head := stream.read(8):
            left, kind = int.from_bytes(head[:4], "big"), head[4:]
            if len(head) < 8 or left > _MAX_CHUNK_BYTES:
                break
            checksum = crc32(kind)
            while left and (block := stream.read(min(left, _BLOCK))):
                checksum, left = crc32(block, checksum), left - len(block)
            stored = stream.read(4)
            if left or len(stored) < 4:
                break
            if int.from_bytes(stored, "big") != checksum:
                name = kind.decode("ascii", "replace")
                raise ValueError(f"it is damaged: the checksum of its part {name!r} is wrong")
            if kind == b"IEND":
                return
    raise ValueError("it is damaged: it ends before its last part")
