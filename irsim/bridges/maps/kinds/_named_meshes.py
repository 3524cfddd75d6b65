"""Meshes that worlds and models name: OBJ files are text and need no library, others are read as the kind ``mesh``."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.grid import Triangles
from irsim.bridges.maps.kinds import mesh
from irsim.bridges.maps.source import ImportLimits, ImportOptions, unusable
from irsim.common.extras import ExtraError, require

__all__ = ["read_named_mesh", "read_obj"]


def read_named_mesh(path: Path, limits: ImportLimits, leave: Callable[[str], None]) -> Triangles | None:
    """Triangles of a file that a world or a model names, in its own axes with z up; None if it cannot be read.

    Args:
        path: The file.
        limits: How large it may be.
        leave: Is called with the reason why the mesh is left out.
    """
    try:
        if path.suffix.lower() == ".obj":
            return read_obj(path, limits)
        require(mesh.KIND.extra, *mesh.KIND.libraries)
        return mesh.read(path, ImportOptions(up="z"), limits).solid
    except ExtraError:
        leave("meshes need the extra: pip install 'irsim-mcp[mesh]'")
    except BridgeError as error:
        leave(str(error))
    return None


def read_obj(path: Path, limits: ImportLimits) -> Triangles:
    """Triangles of the faces of a file in its own axes; a face of more corners becomes a fan.

    Args:
        path: The file.
        limits: How large it may be.

    Raises:
        BridgeError: The file is damaged or too large, or has no faces.
    """
    size = path.stat().st_size
    if size > limits.bytes:
        raise unusable(path, f"it has {size:,} bytes, and at most {limits.bytes:,} are read", "give a smaller file")
    corners: list[list[float]] = []
    faces: list[tuple[int, int, int]] = []
    text = path.read_bytes().decode("utf-8", "replace").replace("\\\r\n", " ").replace("\\\n", " ")
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split()
        try:
            if words[:1] == ["v"]:
                x, y, z = map(float, words[1:4])
                corners.append([x, y, z])
            elif words[:1] == ["f"]:
                face = [_corner(word, len(corners)) for word in words[1:]]
                faces += [(face[0], face[k], face[k + 1]) for k in range(1, len(face) - 1)]
        except ValueError:
            raise unusable(path, f"line {number} is '{line[:60]}', and must be a corner or a face") from None
        if len(faces) > limits.triangles:
            raise unusable(path, f"it has more than {limits.triangles:,} triangles", "give a smaller file")
    if not faces:
        raise unusable(path, "it has no triangles", "export the scene with its meshes")
    points, index = np.array(corners, dtype=np.float64).reshape(-1, 3), np.array(faces)
    if index.min() < 0 or index.max() >= len(points):
        raise unusable(path, "a face names a corner that it does not have")
    if not (np.abs(points) <= 1e9).all():
        raise unusable(path, "some of its points are not numbers")
    triangles: Triangles = points[index]
    return triangles


def _corner(word: str, count: int) -> int:
    """Place of a corner of a face, such as ``3//1``; corners below 0 are counted from the last one so far."""
    number = int(word.partition("/")[0])
    return number - 1 if number > 0 else count + number if number < 0 else -1
