"""Checksums of PNG pictures, which libraries leave out for the parts with pixels."""

from __future__ import annotations

from pathlib import Path

from isal.isal_zlib import crc32

__all__ = ["check_png"]

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_BLOCK = 1 << 20
_MAX_CHUNK_BYTES = 2**31 - 1


def check_png(file: Path) -> None:
    """Check the parts of a PNG picture; a file of another kind passes.

    Raises:
        OSError: The file cannot be read.
        ValueError: A part is damaged or missing.
    """
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
