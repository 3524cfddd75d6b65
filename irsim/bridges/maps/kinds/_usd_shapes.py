"""Triangles of one prim of OpenUSD in its own frame: meshes, cubes, planes, and round shapes."""

# ruff: noqa: E402  # the library is asked for first
from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np

from irsim.bridges.maps.apart import Refused
from irsim.common.arrays import Floats
from irsim.common.extras import require

require("usd", "pxr")
from pxr import UsdGeom

__all__ = ["corners_of", "joined"]

_CUBE = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
"""Sides of a cube whose corner k has x, y, z from the bits of k, counterclockwise from outside."""
_AROUND, _RINGS = 32, 8
"""Corners of round shapes: around the axis, and from the middle of a cap to its rim."""


def joined(parts: list[Floats]) -> Floats:
    """Triangles of several parts, one after the other."""
    return np.concatenate(parts) if parts else np.zeros((0, 3, 3))


def corners_of(prim: Any, time: Any, most: int) -> Floats | None:
    """(T, 3, 3) triangles of a prim in its own frame; None for prims that are not readable surfaces."""
    if prim.IsA(UsdGeom.Mesh):
        return _mesh(UsdGeom.Mesh(prim), str(prim.GetPath()), time, most)
    if prim.IsA(UsdGeom.Cube):
        half = float(UsdGeom.Cube(prim).GetSizeAttr().Get(time)) / 2
        ends = np.array([[half * (1 if k >> axis & 1 else -1) for axis in range(3)] for k in range(8)])
        return np.array([[ends[k] for k in part] for a, b, c, d in _CUBE for part in ((a, b, c), (a, c, d))])
    if prim.IsA(UsdGeom.Sphere):
        radius = float(UsdGeom.Sphere(prim).GetRadiusAttr().Get(time))
        return _turned([(radius * math.cos(a), radius * math.sin(a)) for a in _arc(-90, 90)], "Z")
    if prim.IsA(UsdGeom.Plane):
        return _plane(UsdGeom.Plane(prim), time)
    profile = _profile(prim, time)
    return None if profile is None else _turned(profile, str(prim.GetAttribute("axis").Get(time) or "Z"))


def _arc(start: float, end: float) -> list[float]:
    steps = max(1, round(abs(end - start) / 90 * _RINGS))
    return [math.radians(start + (end - start) * k / steps) for k in range(steps + 1)]


def _profile(prim: Any, time: Any) -> list[tuple[float, float]] | None:
    """Radius and height of the rim of a shape around an axis, from its bottom to its top."""

    def value(name: str) -> float:
        return float(prim.GetAttribute(name).Get(time))

    kind = str(prim.GetTypeName())
    if kind in ("Cylinder", "Cylinder_1", "Cone", "Capsule", "Capsule_1"):
        half = value("height") / 2
        ends = ("radiusBottom", "radiusTop") if kind.endswith("_1") else ("radius", "radius")
        low, high = value(ends[0]), value(ends[1])
        if kind == "Cone":
            return [(0.0, -half), (low, -half), (0.0, half)]
        if kind.startswith("Cylinder"):
            return [(0.0, -half), (low, -half), (high, half), (0.0, half)]
        below = [(low * math.cos(a), low * math.sin(a) - half) for a in _arc(-90, 0)]
        return below + [(high * math.cos(a), high * math.sin(a) + half) for a in _arc(0, 90)]
    return None


def _plane(plane: Any, time: Any) -> Floats:
    """Both sides of a rectangle; its width and length are along x and y if its axis is z, z and y if it is x."""
    half = np.array([float(plane.GetWidthAttr().Get(time)), float(plane.GetLengthAttr().Get(time))]) / 2
    flat = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half
    order = {"X": [2, 1, 0], "Y": [0, 2, 1]}.get(str(plane.GetAxisAttr().Get(time)), [0, 1, 2])
    ends = np.column_stack([flat, np.zeros(4)])[:, order]
    return np.array([[ends[k] for k in part] for part in ((0, 1, 2), (0, 2, 3), (2, 1, 0), (3, 2, 0))])


def _turned(profile: list[tuple[float, float]], axis: str) -> Floats:
    """Triangles of the surface that a profile makes around an axis, counterclockwise from outside."""
    angle = np.linspace(0, 2 * math.pi, _AROUND, endpoint=False)
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    rings = [np.column_stack([radius * circle, np.full(_AROUND, height)]) for radius, height in profile]
    parts = []
    for low, high in itertools.pairwise(rings):
        a, b, c, d = low, np.roll(low, -1, axis=0), np.roll(high, -1, axis=0), high
        parts += [np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]
    triangles = joined(parts)
    order = {"X": [2, 0, 1], "Y": [1, 2, 0]}.get(axis, [0, 1, 2])
    return np.ascontiguousarray(triangles[..., order])


def _mesh(mesh: Any, name: str, time: Any, most: int) -> Floats:
    values = [attr.Get(time) for attr in (mesh.GetPointsAttr(), mesh.GetFaceVertexCountsAttr())]
    index = mesh.GetFaceVertexIndicesAttr().Get(time)
    if index is None or any(value is None for value in values):
        return np.zeros((0, 3, 3))
    points = np.asarray(values[0], dtype=np.float64).reshape(-1, 3)
    counts, index = np.asarray(values[1], dtype=np.int64), np.asarray(index, dtype=np.int64)
    if (counts < 0).any() or counts.sum() != len(index):
        raise Refused(f"the faces of {name} need {counts.sum():,} vertices, and {len(index):,} are named")
    if len(index) and (index.min() < 0 or index.max() >= len(points)):
        raise Refused(f"a face of {name} names a vertex that it does not have")
    triangles = np.maximum(counts - 2, 0)
    if triangles.sum() > most:
        raise Refused("it has too many triangles", "simplify the stage")
    face = np.repeat(np.arange(len(counts)), triangles)
    step = np.arange(len(face)) - np.repeat(np.cumsum(triangles) - triangles, triangles)
    first = (np.cumsum(counts) - counts)[face]
    corners: Floats = points[np.stack([index[first], index[first + step + 1], index[first + step + 2]], axis=1)]
    left_handed = mesh.GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded
    return corners[:, ::-1] if left_handed else corners
