"""The process that reads meshes: glTF by its description, other files by trimesh after their headers are checked."""

from __future__ import annotations

import io
import logging
import re
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from irsim.bridges.maps.apart import Refused, serve
from irsim.bridges.maps.grid import Triangles
from irsim.bridges.maps.kinds._gltf import open_scene
from irsim.bridges.maps.kinds._headers import check_ply, check_stl
from irsim.bridges.maps.source import ImportLimits
from irsim.common.extras import require

__all__ = ["load", "main"]

_Y_UP = (".glb", ".gltf", ".obj")
_MAX_TEXT = 512 * 1024**2
"""Size of a file of text, whose reader takes many times as much memory [bytes]."""


def main() -> None:
    """Read the request, answer it."""
    logging.getLogger("trimesh").setLevel(logging.CRITICAL)
    serve(load)


def load(path: Path, request: dict[str, Any]) -> tuple[Triangles, dict[str, Any]]:
    """Triangles of a file, and its axis that points up, its unit [m] and notes.

    Raises:
        BridgeError: The header does not fit the file.
        Refused: The file cannot be used.
    """
    limits = ImportLimits(bytes=int(request["bytes"]), triangles=int(request["triangles"]))
    suffix = path.suffix.lower()
    said: dict[str, Any] = {"up": "y" if suffix in _Y_UP else "z", "unit": 1.0, "notes": []}
    if suffix in (".obj", ".dae") and path.stat().st_size > _MAX_TEXT:
        raise Refused(f"as text it may have at most {_MAX_TEXT:,} bytes", "convert it to .glb")
    if suffix in (".glb", ".gltf"):
        root = None if request.get("root") is None else Path(request["root"])
        with np.errstate(all="ignore"):
            parts = [_placed(*part) for part in open_scene(path, limits, root).triangles()]
        return _joined(parts), said
    if suffix == ".stl":
        check_stl(path)
    elif suffix == ".ply":
        check_ply(path)
    elif suffix == ".dae":
        require("mesh", "collada")
        said |= _collada(path)
    return _joined(_read(path, suffix.lstrip("."), limits)), said


def _joined(parts: list[Triangles]) -> Triangles:
    return np.concatenate(parts) if parts else np.zeros((0, 3, 3))


def _collada(path: Path) -> dict[str, Any]:
    """Axis and unit of a file of COLLADA."""
    head = path.read_bytes()
    if b"<!DOCTYPE" in head or b"<!ENTITY" in head:
        raise Refused("it declares a type of document or entities", "remove the lines with <! from it")
    axis = re.search(rb"<up_axis>\s*([XYZ])_UP", head)
    unit = re.search(rb"<unit\b[^>]*\bmeter\s*=\s*[\"']([-+.0-9eE]{1,30})[\"']", head)
    up = axis[1].decode().lower() if axis else "y"
    if up == "x":
        raise Refused("x points up in it", "export it with y or z up")
    meters = float(unit[1]) if unit else 1.0
    if not 1e-6 <= meters <= 1e6:
        raise Refused(f"its unit is {meters:g} m", "set the unit of the file")
    return {"up": up, "unit": meters}


def _read(path: Path, suffix: str, limits: ImportLimits) -> list[Triangles]:
    """Corners of the triangles of each node."""
    result: list[Triangles] = []
    with np.errstate(all="ignore"):
        content = io.BytesIO(path.read_bytes())
        scene = trimesh.load_scene(content, suffix, skip_materials=True, process=False)
        total = 0
        for node in sorted(scene.graph.nodes_geometry):
            matrix, name = scene.graph[node]
            mesh = scene.geometry[name]
            if not isinstance(mesh, trimesh.Trimesh):
                continue
            total += len(mesh.faces)
            if total > limits.triangles:
                raise Refused(f"it has more than {limits.triangles:,} triangles", "simplify the mesh")
            result.append(_placed(mesh.vertices, mesh.faces, matrix))
    return result


def _placed(vertices: Any, faces: Any, matrix: Any) -> Triangles:
    """Corners of the faces of a node, (F, 3, 3), in the frame of the file."""
    points, faces = np.asarray(vertices, dtype=np.float64), np.asarray(faces)
    if len(faces) and (faces.min() < 0 or faces.max() >= len(points)):
        raise Refused(f"a face names vertex {int(faces.max())}, and there are {len(points)}")
    matrix = np.asarray(matrix, dtype=np.float64)
    points = points @ matrix[:3, :3].T + matrix[:3, 3]
    corners = points.astype(np.float32)[faces] if np.abs(points).max(initial=0) < 1e4 else points[faces]
    placed: Triangles = corners[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0 else corners
    return placed
