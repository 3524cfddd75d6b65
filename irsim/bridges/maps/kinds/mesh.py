"""``mesh``: glTF, OBJ, PLY and STL files, read by trimesh after their headers have been checked."""

from __future__ import annotations

import io
import logging
import struct
from pathlib import Path
from typing import Any

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.grid import Triangles
from irsim.bridges.maps.kinds import _gltf
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Kind, Scene, unusable

__all__ = ["KIND", "check_ply", "check_stl", "may_be_mesh", "ply_header"]

_MAX_HEADER = 64 * 1024
_SIZES = {
    "char": 1, "uchar": 1, "int8": 1, "uint8": 1, "short": 2, "ushort": 2, "int16": 2, "uint16": 2, "int": 4, "uint": 4,
    "int32": 4, "uint32": 4, "float": 4, "float32": 4, "double": 8, "float64": 8,
}  # fmt: skip


def may_be_mesh(head: bytes) -> bool:
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
    lines = head.split(b"\n")[:200]
    return any(line.split()[:1] in ([b"v"], [b"f"], [b"o"], [b"g"], [b"mtllib"]) for line in lines)


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


_FRAMES = {"y": "habitat_yup", "z": "irsim", "-y": "colmap"}
_Y_UP = (".glb", ".gltf", ".obj")
_MAX_TEXT = 512 * 1024**2
"""Size of an OBJ file [bytes], which needs many times as much memory."""
_STEEP = 1.5
"""How much more area must face along another axis before a note says so."""


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> Scene:
    """Triangles of a mesh file.

    Raises:
        BridgeError: The file is damaged, refers to other files, or has no triangles.
    """
    suffix = path.suffix.lower().lstrip(".")
    resolver = None
    if suffix == "obj" and path.stat().st_size > _MAX_TEXT:
        raise unusable(path, f"as text it may have at most {_MAX_TEXT:,} bytes", "convert it to .glb")
    if suffix in ("glb", "gltf"):
        resolver = _gltf.check(path, limits)
    elif suffix == "stl":
        check_stl(path)
    elif suffix == "ply":
        check_ply(path)
    up = options.up if options.up != "auto" else ("y" if path.suffix.lower() in _Y_UP else "z")
    triangles = _checked(path, _load(path, suffix, resolver, limits))
    areas = np.abs(_normals(triangles)).sum(axis=0)
    notes = []
    axis = {"y": 1, "z": 2, "-y": 1}[up]
    other = 3 - axis
    if options.up == "auto" and areas[other] > _STEEP * areas[axis]:
        name = "xyz"[other]
        notes.append(f"most surfaces face along {name}: if {name} points up, give --up {name}")
    if up == "y":
        triangles = np.stack([triangles[..., 0], -triangles[..., 2], triangles[..., 1]], axis=-1)
    elif up == "-y":
        triangles = np.stack([triangles[..., 2], -triangles[..., 0], -triangles[..., 1]], axis=-1)
    rises = _normals(triangles)[:, 2]
    upward, downward = float(rises[rises > 0].sum()), float(-rises[rises < 0].sum())
    if upward < 0.1 * downward:
        triangles = np.ascontiguousarray(triangles[:, ::-1])
        notes.append("its surfaces face downward, so that all were turned around")
    unit = options.meters_per_unit or 1.0
    if unit != 1.0:
        triangles = triangles.astype(np.float64) * unit
    return Scene(_FRAMES[up], triangles, meters_per_unit=unit, notes=notes)


def _load(path: Path, suffix: str, resolver: Any, limits: ImportLimits) -> list[Triangles]:
    import trimesh

    logger = logging.getLogger("trimesh")
    level = logger.level
    logger.setLevel(logging.CRITICAL)
    result: list[Triangles] = []
    try:
        with np.errstate(all="ignore"):
            content = io.BytesIO(path.read_bytes())
            scene = trimesh.load_scene(content, suffix, resolver, skip_materials=True, process=False)
            total = 0
            for node in sorted(scene.graph.nodes_geometry):
                matrix, name = scene.graph[node]
                mesh = scene.geometry[name]
                if not isinstance(mesh, trimesh.Trimesh):
                    continue
                total += len(mesh.faces)
                if total > limits.triangles:
                    raise unusable(path, f"it has more than {limits.triangles:,} triangles", "simplify the mesh")
                result.append(_placed(path, mesh.vertices, mesh.faces, matrix))
    except BridgeError:
        raise
    except MemoryError:
        raise unusable(path, "it does not fit into memory", "simplify the mesh") from None
    except Exception as error:  # whatever the reader stumbles over is the file's fault
        raise unusable(path, f"it is damaged ({_reason(error)})") from None
    finally:
        logger.setLevel(level)
    return result


def _placed(path: Path, vertices: Any, faces: Any, matrix: Any) -> Triangles:
    """Corners of the faces of a node, (F, 3, 3), in the frame of the file."""
    points, faces = np.asarray(vertices, dtype=np.float64), np.asarray(faces)
    if len(faces) and (faces.min() < 0 or faces.max() >= len(points)):
        raise unusable(path, f"a face names vertex {int(faces.max())}, and there are {len(points)}")
    matrix = np.asarray(matrix, dtype=np.float64)
    points = points @ matrix[:3, :3].T + matrix[:3, 3]
    corners = points.astype(np.float32)[faces] if np.abs(points).max(initial=0) < 1e4 else points[faces]
    placed: Triangles = corners[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0 else corners
    return placed


def _checked(path: Path, parts: list[Triangles]) -> Triangles:
    if not parts or not sum(map(len, parts)):
        raise unusable(path, "it has no triangles", "export the scene with its meshes")
    triangles = np.concatenate(parts)
    wrong = ~np.isfinite(triangles).all(axis=(1, 2))
    if wrong.any():
        raise unusable(path, f"{int(wrong.sum()):,} of its {len(wrong):,} triangles have corners that are not numbers")
    return triangles


def _normals(triangles: Triangles) -> Any:
    """(T, 3) normals whose length is twice the area."""
    return np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])


def _reason(error: Exception) -> str:
    lines = str(error).splitlines()
    return f"{type(error).__name__}: {lines[0][:100]}" if lines and lines[0] else type(error).__name__


KIND = Kind(
    name="mesh",
    title="a mesh",
    suffixes=(".glb", ".gltf", ".obj", ".ply", ".stl"),
    accepts=may_be_mesh,
    read=read,
    libraries=("trimesh",),
    unused=("opacity", "lanes", "root"),
)
