"""Checks that STL and PLY files have the content that their headers promise, before a reader allocates anything."""

from __future__ import annotations

import struct
from pathlib import Path

from irsim.bridges.maps.source import unusable

__all__ = ["check_ply", "check_stl"]

_MAX_HEADER = 64 * 1024
_SIZES = {
    "char": 1, "uchar": 1, "int8": 1, "uint8": 1, "short": 2, "ushort": 2, "int16": 2, "uint16": 2, "int": 4, "uint": 4,
    "int32": 4, "uint32": 4, "float": 4, "float32": 4, "double": 8, "float64": 8,
}  # fmt: skip


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
    elements, text, start = ply_header(path)
    left = path.stat().st_size - start
    if not any(name == "face" and count for name, count, _ in elements):
        splats = any("f_dc_0" in properties for _, _, properties in elements)
        what = "it holds Gaussian splats, and no faces" if splats else "it has no faces, only points"
        raise unusable(path, what, "give a mesh")
    need = 0
    for _, count, properties in elements:
        need += count * (2 * len(properties) if text else sum(properties.values()))
    if need > left + (2 if text else 0):
        raise unusable(path, f"its header promises at least {need:,} bytes after byte {start}, and there are {left:,}")


def ply_header(path: Path) -> tuple[list[tuple[str, int, dict[str, int]]], bool, int]:
    """Elements (name, count, property -> smallest size [bytes]), whether the file is text, and where its data begin.

    Raises:
        BridgeError: The header is damaged.
    """
    with path.open("rb") as file:
        head = file.read(_MAX_HEADER)
    end = head.find(b"end_header")
    stop = head.find(b"\n", end)
    if not head.startswith(b"ply") or end < 0 or stop < 0:
        raise unusable(path, "its header has no end")
    elements: list[tuple[str, int, dict[str, int]]] = []
    text = False
    for number, line in enumerate(head[:end].decode("latin-1").splitlines(), start=1):
        words = line.split()
        try:
            if words[:1] == ["format"]:
                text = words[1] == "ascii"
            elif words[:1] == ["element"]:
                count = int(words[2])
                if count < 0:
                    raise ValueError
                elements.append((words[1], count, {}))
            elif words[:2] == ["property", "list"]:
                least = 3 * _SIZES[words[3]] if elements[-1][0] == "face" else 0
                elements[-1][2][words[4]] = _SIZES[words[2]] + least
            elif words[:1] == ["property"]:
                elements[-1][2][words[2]] = _SIZES[words[1]]
        except (IndexError, KeyError, ValueError):
            raise unusable(path, f"line {number} of its header is '{line[:80]}'") from None
    return elements, text, stop + 1
