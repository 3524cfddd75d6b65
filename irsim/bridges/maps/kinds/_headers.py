"""Checks that STL and PLY files have the content that their headers promise, before a reader allocates anything."""

from __future__ import annotations

import struct
from pathlib import Path

from irsim.bridges.maps.source import unusable
from irsim.bridges.ply import read_header

__all__ = ["check_ply", "check_stl"]


def check_stl(path: Path) -> None:
    """Check the number of triangles of a binary file.

    Raises:
        BridgeError: The file is shorter than that.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(84)
    if head.lstrip().startswith(b"solid") and (size < 84 or size != 84 + 50 * struct.unpack_from("<I", head, 80)[0]):
        return  # text
    if size < 84:
        raise unusable(path, f"it ends within its header, after {size} bytes")
    count = int(struct.unpack_from("<I", head, 80)[0])
    if size != 84 + 50 * count:
        raise unusable(path, f"its header promises {count:,} triangles, {84 + 50 * count:,} bytes, and it has {size:,}")


def check_ply(path: Path) -> None:
    """Check the counts of the header against the size of the file.

    Raises:
        BridgeError: The header is damaged, the file is shorter than it says, or has no faces.
    """
    header = read_header(path, "give a mesh")
    left = path.stat().st_size - header.size
    text = header.encoding == "ascii"
    if not any(item.name == "face" and item.count for item in header.elements):
        splats = any(column.name == "f_dc_0" for item in header.elements for column in item.properties)
        what = "it holds Gaussian splats, and no faces" if splats else "it has no faces, only points"
        raise unusable(path, what, "give a mesh")
    need = 0
    for item in header.elements:
        least = 3 if item.name == "face" else 0
        need += item.count * (2 * len(item.properties) if text else item.row_bytes(least))
    if need > left + (2 if text else 0):
        what = f"its header promises at least {need:,} bytes after byte {header.size}, and there are {left:,}"
        raise unusable(path, what)
