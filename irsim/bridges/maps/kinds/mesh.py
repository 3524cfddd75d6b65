"""``mesh``: glTF, OBJ, PLY and STL files, read by trimesh after their headers have been checked."""

from __future__ import annotations

import io
import logging
from pathlib import Path
from typing import Any

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.grid import Triangles
from irsim.bridges.maps.kinds import _gltf, _mesh_headers
from irsim.bridges.maps.options import ImportLimits, ImportOptions
from irsim.bridges.maps.source import Kind, Scene, unusable

__all__ = ["KIND"]

_FRAMES = {"y": "habitat_yup", "z": "irsim", "-y": "colmap"}
_Y_UP = (".glb", ".gltf", ".obj")
_MAX_TEXT = 512 * 1024**2
"""Size of an OBJ file [bytes], which needs many times as much memory."""
_STEEP = 1.5
"""How much more area must face along another axis before a note says so."""


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> Scene:
    """Triangles of a mesh file.

    Raises:
        BridgeError: The file is damaged, refers to others, or has no triangles.
    """
    suffix = path.suffix.lower().lstrip(".")
    resolver = None
    if suffix == "obj" and path.stat().st_size > _MAX_TEXT:
        raise unusable(path, f"as text it may have at most {_MAX_TEXT:,} bytes", "convert it to .glb")
    if suffix in ("glb", "gltf"):
        resolver = _gltf.check(path, limits)
    elif suffix == "stl":
        _mesh_headers.check_stl(path)
    elif suffix == "ply":
        _mesh_headers.check_ply(path)
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
    found: list[Triangles] = []
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
                found.append(_placed(path, mesh.vertices, mesh.faces, matrix))
    except BridgeError:
        raise
    except MemoryError:
        raise unusable(path, "it does not fit into memory", "simplify the mesh") from None
    except Exception as error:  # whatever the reader stumbles over is the file's fault
        raise unusable(path, f"it is damaged ({_reason(error)})") from None
    finally:
        logger.setLevel(level)
    return found


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
        raise unusable(path, f"{int(wrong.sum()):,} of its {len(wrong):,} triangles have corners that are no numbers")
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
    accepts=_mesh_headers.may_be_mesh,
    read=read,
    libraries=("trimesh",),
    unused=("opacity", "lanes"),
)
