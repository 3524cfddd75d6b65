"""The process that reads a stage of OpenUSD: JSON as a request and as an answer, triangles to a file."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["main"]

_MEMORY = 12 * 1024**3
"""Address space of the process [bytes]."""
_MAX_LAYERS = 5_000
_CUBE = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
"""Sides of a cube whose corner k has x, y, z from the bits of k, counterclockwise from outside."""


class _Refused(Exception):
    """The stage cannot be used; the second argument is the advice."""


def main() -> None:
    """Read the request, answer it."""
    request = json.loads(sys.stdin.read())
    with suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    try:
        answer = _read(Path(request["file"]), Path(request["out"]), int(request["triangles"]))
    except _Refused as refused:
        answer = dict(zip(("error", "fix"), refused.args, strict=False))
    except MemoryError:
        answer = {"error": "it does not fit into memory", "fix": "give a smaller stage"}
    except Exception as error:  # whatever the library stumbles over is the file's fault
        answer = {"error": f"it is damaged ({type(error).__name__}: {str(error).strip().splitlines()[-1][:150]})"}
    print("\n" + json.dumps(answer), flush=True)
    os._exit(0)  # what the library does at its end can fail, and nothing is left to do


def _read(path: Path, out: Path, most: int) -> dict[str, Any]:
    from pxr import Usd, UsdGeom

    missing = _check_layers(path)
    stage = Usd.Stage.Open(str(path))
    if stage is None:
        raise _Refused("it is damaged: no stage can be opened from it")
    up = str(UsdGeom.GetStageUpAxis(stage))
    scale = float(UsdGeom.GetStageMetersPerUnit(stage))
    if not 1e-6 <= scale <= 1e6:
        raise _Refused(f"its metersPerUnit is {scale:g}", "set metersPerUnit of the stage")
    parts: list[np.ndarray] = []
    total, left_out = 0, set()
    cache = UsdGeom.XformCache(Usd.TimeCode.EarliestTime())
    for prim in _visible(stage):
        corners = _corners(prim, most - total)
        if corners is None:
            if prim.IsA(UsdGeom.Gprim) or prim.IsA(UsdGeom.PointInstancer):
                left_out.add(str(prim.GetTypeName()))
            continue
        total += len(corners)
        if total > most:
            raise _Refused(f"it has more than {most:,} triangles", "simplify the stage")
        matrix = np.array(cache.GetLocalToWorldTransform(prim))
        with np.errstate(all="ignore"):
            placed = corners @ matrix[:3, :3] + matrix[3, :3]
        parts.append(placed[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0 else placed)
    triangles = np.concatenate(parts) * scale if parts else np.zeros((0, 3, 3))
    if up == "Y":
        triangles = np.stack([triangles[..., 0], -triangles[..., 2], triangles[..., 1]], axis=-1)
    np.savez(out, triangles=triangles)
    notes = [f"prims of these types were left out: {', '.join(sorted(left_out))}"] if left_out else []
    if missing:
        notes.append(f"{len(missing)} of its layers were not found, such as '{missing[0][:150]}'")
    return {"meters_per_unit": scale, "frame": "usd_yup" if up == "Y" else "usd", "notes": notes}


def _visible(stage: Any) -> Iterator[Any]:
    """Prims that are drawn, those of instances as well."""
    from pxr import Usd, UsdGeom

    prims = iter(Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)))
    for prim in prims:
        image = UsdGeom.Imageable(prim)
        if not image:
            continue
        hidden = image.GetVisibilityAttr().Get(Usd.TimeCode.EarliestTime()) == UsdGeom.Tokens.invisible
        if hidden or image.GetPurposeAttr().Get() in (UsdGeom.Tokens.guide, UsdGeom.Tokens.proxy):
            prims.PruneChildren()
            continue
        if prim.HasAuthoredMetadata("clips"):
            raise _Refused(f"{prim.GetPath()} has value clips, which are other files", "flatten the stage")
        yield prim


def _corners(prim: Any, most: int) -> np.ndarray | None:
    """(T, 3, 3) triangles of a mesh or a cube in its own frame; None for others."""
    from pxr import Usd, UsdGeom

    time = Usd.TimeCode.EarliestTime()
    if prim.IsA(UsdGeom.Cube):
        half = float(UsdGeom.Cube(prim).GetSizeAttr().Get(time)) / 2
        ends = np.array([[half * (1 if k >> axis & 1 else -1) for axis in range(3)] for k in range(8)])
        return np.array([[ends[k] for k in part] for a, b, c, d in _CUBE for part in ((a, b, c), (a, c, d))])
    if not prim.IsA(UsdGeom.Mesh):
        return None
    mesh = UsdGeom.Mesh(prim)
    values = [attr.Get(time) for attr in (mesh.GetPointsAttr(), mesh.GetFaceVertexCountsAttr())]
    index = mesh.GetFaceVertexIndicesAttr().Get(time)
    if index is None or any(value is None for value in values):
        return np.zeros((0, 3, 3))
    points = np.asarray(values[0], dtype=np.float64).reshape(-1, 3)
    counts, index = np.asarray(values[1], dtype=np.int64), np.asarray(index, dtype=np.int64)
    name = str(prim.GetPath())
    if (counts < 0).any() or counts.sum() != len(index):
        raise _Refused(f"the faces of {name} need {counts.sum():,} vertices, and {len(index):,} are named")
    if len(index) and (index.min() < 0 or index.max() >= len(points)):
        raise _Refused(f"a face of {name} names a vertex that it does not have")
    triangles = np.maximum(counts - 2, 0)
    if triangles.sum() > most:
        raise _Refused("it has too many triangles", "simplify the stage")
    face = np.repeat(np.arange(len(counts)), triangles)
    step = np.arange(len(face)) - np.repeat(np.cumsum(triangles) - triangles, triangles)
    first = (np.cumsum(counts) - counts)[face]
    corners: np.ndarray = points[np.stack([index[first], index[first + step + 1], index[first + step + 2]], axis=1)]
    left_handed = mesh.GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded
    return corners[:, ::-1] if left_handed else corners


def _check_layers(path: Path) -> list[str]:
    """All layers that the stage is made of lie in the folder of the file, or inside of it; those that are missing."""
    from pxr import Sdf

    root = path.resolve().parent
    waiting, met = [str(path)], set[str]()
    missing = []
    while waiting:
        name = waiting.pop()
        if name in met:
            continue
        met.add(name)
        if len(met) > _MAX_LAYERS:
            raise _Refused(f"it is made of more than {_MAX_LAYERS:,} layers")
        layer = Sdf.Layer.FindOrOpen(name)
        if layer is None:
            if name == str(path):
                raise _Refused("it is damaged: it cannot be opened")
            missing.append(os.path.basename(name))
            continue  # the stage is composed without it
        for asset in filter(None, layer.GetCompositionAssetDependencies()):  # no name stands for the layer itself
            target = layer.ComputeAbsolutePath(asset)
            _check_reference(asset, target, root, path)
            waiting.append(target)
    return missing


def _check_reference(asset: str, target: str, root: Path, path: Path) -> None:
    file = target.partition("[")[0]
    inside = os.path.isabs(file) and "://" not in target and Path(file).resolve().is_relative_to(root)
    if os.path.isabs(asset) or "://" in asset or not inside:
        shown = asset[:150]
        fix = "put all its files into one folder, or flatten the stage: usdcat --flatten"
        raise _Refused(f"it refers to '{shown}', which is outside of its folder and is not read", fix)


if __name__ == "__main__":
    main()
