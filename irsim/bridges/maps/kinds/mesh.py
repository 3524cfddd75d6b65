"""``mesh``: glTF, OBJ, PLY, STL and COLLADA files, read in a process of its own, from whose facts the map is made."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np

from irsim.bridges.maps.apart import read_apart
from irsim.bridges.maps.grid import Triangles, turned
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Kind, SceneTriangles, unusable

__all__ = ["KIND", "read_triangles"]


def _may_be_mesh(head: bytes) -> bool:
    """Whether the first bytes of a file look like one of the formats of meshes."""
    if head.startswith((b"glTF", b"solid")):
        return True
    if head.startswith(b"ply"):
        return b"element face" in head or not any(mark in head for mark in (b"f_dc_0", b"scale_0", b"packed_"))
    if head.lstrip().startswith(b"{"):
        return b"asset" in head or b"accessors" in head or b"nodes" in head
    if len(head) >= 84 and not head.startswith((b"TESM", b"PXR-USDC", b"#usda", b"PK", b"\x89PNG")):
        count = int(struct.unpack_from("<I", head, 80)[0])
        if len(head) == 84 + 50 * count or (len(head) >= 4096 and b"\0" in head[:84]):
            return True
    if b"<COLLADA" in head:
        return True
    lines = head.split(b"\n")[:200]
    return any(line.split()[:1] in ([b"v"], [b"f"], [b"o"], [b"g"], [b"mtllib"]) for line in lines)


_FRAMES = {"y": "habitat_yup", "z": "irsim", "-y": "colmap"}
_FARTHEST = 1e12
"""Largest coordinate of a corner, in the unit of the file."""
_STEEP = 1.5
"""How much more area must face along another axis before a note says so."""


def read_triangles(path: Path, limits: ImportLimits, root: str | None = None) -> tuple[Triangles, dict[str, Any]]:
    """Triangles of a mesh, read in a process of its own.

    Args:
        path: File whose suffix says its format: ``.glb``, ``.gltf``, ``.obj``, ``.ply``, ``.stl`` or ``.dae``.
        limits: How much it may cost.
        root: A second folder whose files a ``.gltf`` may refer to, besides its own one; None for none.

    Returns:
        (T, 3, 3) corners, counterclockwise seen from outside, frame and unit of the file; and ``up``, the axis that
        points up by the file or its format (``y`` or ``z``), ``unit``, the length of a unit [m], and ``notes``.

    Raises:
        BridgeError: The file is damaged, refers to other files, or has no triangles.
    """
    triangles, said = read_apart(
        path, f"{__package__}._mesh_process", limits, {"root": root and str(Path(root).resolve())}
    )
    return _checked(path, triangles), said


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> SceneTriangles:
    """Triangles of a mesh file.

    Raises:
        BridgeError: The file is damaged, refers to other files, or has no triangles.
    """
    triangles, said = read_triangles(path, limits, options.root)
    triangles, turn = turned(triangles, options.rotate)
    up = said["up"] if options.up == "auto" else options.up
    areas = np.abs(_normals(triangles)).sum(axis=0)
    notes = list(said["notes"])
    axis = {"y": 1, "z": 2, "-y": 1}[up]
    if options.up == "auto" and areas[3 - axis] > _STEEP * areas[axis]:
        usual, up = up, "xyz"[3 - axis]
        notes.append(f"most surfaces face along {up}, which is taken to point up: if {usual} does, give --up {usual}")
    if up == "y":
        triangles = np.stack([triangles[..., 0], -triangles[..., 2], triangles[..., 1]], axis=-1)
    elif up == "-y":
        triangles = np.stack([triangles[..., 2], -triangles[..., 0], -triangles[..., 1]], axis=-1)
    rises = _normals(triangles)[:, 2]
    upward, downward = float(rises[rises > 0].sum()), float(-rises[rises < 0].sum())
    if upward < 0.1 * downward:
        triangles = np.ascontiguousarray(triangles[:, ::-1])
        notes.append("its surfaces face downward, so that all were turned around")
    unit = options.meters_per_unit or float(said["unit"])
    if unit != 1.0:
        triangles = triangles.astype(np.float64) * unit
    return SceneTriangles(_FRAMES[up], triangles, meters_per_unit=unit, notes=notes, turn=turn)


def _checked(path: Path, triangles: Triangles) -> Triangles:
    if not len(triangles):
        raise unusable(path, "it has no triangles", "export the scene with its meshes")
    wrong = ~(np.abs(triangles) <= _FARTHEST).all(axis=(1, 2))
    if wrong.any():
        what = f"{int(wrong.sum()):,} of its {len(triangles):,} triangles have corners"
        raise unusable(path, f"{what} that are not numbers of at most {_FARTHEST:g}")
    return triangles


def _normals(triangles: Triangles) -> Any:
    """(T, 3) normals whose length is twice the area."""
    return np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])


KIND = Kind(
    name="mesh",
    title="a mesh",
    suffixes=(".glb", ".gltf", ".obj", ".ply", ".stl", ".dae"),
    accepts=_may_be_mesh,
    roots=("COLLADA",),
    read=read,
    libraries=("trimesh",),
    unused=("opacity", "lanes"),
)
