"""The process that reads a stage of OpenUSD: JSON as a request and as an answer, triangles to a file."""

# ruff: noqa: E402  # the library is asked for first
from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from irsim.bridges.maps.apart import Refused, serve
from irsim.bridges.maps.kinds._usd_layers import Layers
from irsim.bridges.maps.kinds._usd_shapes import corners_of, joined
from irsim.common.arrays import Floats
from irsim.common.extras import require

require("usd", "pxr")
from pxr import Usd, UsdGeom

__all__ = ["Collector", "main"]

_MAX_DEPTH = 8
"""How deep instancers may be nested."""


class Collector:
    """Collects triangles of all prims that are drawn.

    Args:
        most: Largest number of triangles.

    Attributes:
        left_out: Types of prims that have surfaces which are not read.
        parts: Path of each prim that was read, and how many triangles it has.
    """

    def __init__(self, most: int) -> None:
        self.left_out: set[str] = set()
        self.parts: list[tuple[str, int]] = []
        self._room = self._most = most
        self._time = Usd.TimeCode.EarliestTime()
        self._cache = UsdGeom.XformCache(self._time)

    def stage(self, stage: Any) -> Floats:
        """(T, 3, 3) corners of the triangles of a stage, frame and unit of the stage."""
        prims = Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate))
        result = []
        for prim in self._drawn(prims):
            result.append(self._one(prim, self._world, 0))
            self.parts.append((str(prim.GetPath()), len(result[-1])))
        return joined(result)

    def _world(self, prim: Any) -> Any:
        return self._cache.GetLocalToWorldTransform(prim)

    def _drawn(self, prims: Any) -> Iterator[Any]:
        """Prims that are drawn, but for those below an instancer, which are only its prototypes."""
        prims = iter(prims)
        for prim in prims:
            image = UsdGeom.Imageable(prim)
            if not image:
                continue
            hidden = image.GetVisibilityAttr().Get(self._time) == UsdGeom.Tokens.invisible
            if hidden or image.GetPurposeAttr().Get() in (UsdGeom.Tokens.guide, UsdGeom.Tokens.proxy):
                prims.PruneChildren()
                continue
            if prim.IsA(UsdGeom.PointInstancer):
                prims.PruneChildren()
            yield prim

    def _one(self, prim: Any, place: Any, depth: int) -> Floats:
        """Triangles of one prim; ``place`` gives its transform."""
        if prim.IsA(UsdGeom.PointInstancer):
            corners = self._instances(UsdGeom.PointInstancer(prim), depth)
        else:
            result = corners_of(prim, self._time, self._room)
            if result is None and prim.IsA(UsdGeom.Gprim):
                self.left_out.add(str(prim.GetTypeName()))
            if result is None:
                return np.zeros((0, 3, 3))
            corners = result
            self._take(len(corners))
        return _placed(corners, place(prim))

    def _take(self, triangles: int) -> None:
        self._room -= triangles
        if self._room < 0:
            raise Refused(f"it has more than {self._most:,} triangles", "simplify the stage")

    def _instances(self, instancer: Any, depth: int) -> Floats:
        """Triangles of all instances, frame of the instancer."""
        index, transforms = self._arrangement(instancer)
        parts = []
        for number, path in enumerate(instancer.GetPrototypesRel().GetForwardedTargets()):
            which = np.flatnonzero(index == number)
            if not len(which):
                continue
            room = self._room
            one = self._prototype(instancer.GetPrim().GetStage().GetPrimAtPath(path), depth + 1)
            self._room = room
            self._take(len(one) * len(which))
            parts += [_placed(one, transforms[int(k)]) for k in which]
        return joined(parts)

    def _arrangement(self, instancer: Any) -> tuple[Any, Any]:
        """Number of the prototype of each instance that is shown, and its transform."""
        index = np.asarray(instancer.GetProtoIndicesAttr().Get(self._time) or [], dtype=np.int64)
        mask = np.asarray(instancer.ComputeMaskAtTime(self._time), dtype=bool)
        name = str(instancer.GetPath())
        if len(mask) not in (0, len(index)):
            raise Refused(f"the instances of {name} and what hides them do not fit together")
        transforms = instancer.ComputeInstanceTransformsAtTime(self._time, self._time) if len(index) else []
        index = index[mask] if len(mask) else index
        if len(transforms) != len(index):
            raise Refused(f"{name} has {len(index):,} instances, and places for {len(transforms):,}")
        return index, transforms

    def _prototype(self, root: Any, depth: int) -> Floats:
        """Triangles of a prototype, frame of its own prim."""
        if depth > _MAX_DEPTH:
            raise Refused(f"its instancers are nested more than {_MAX_DEPTH} deep", "flatten the stage")
        if not root:
            return np.zeros((0, 3, 3))

        def place(prim: Any) -> Any:
            return self._cache.ComputeRelativeTransform(prim, root)[0]

        # A prototype may be an `over` or a class, which is drawn only where it is an instance.
        prims = Usd.PrimRange(root, Usd.TraverseInstanceProxies(Usd.PrimIsActive & Usd.PrimIsLoaded))
        return joined([self._one(prim, place, depth) for prim in self._drawn(prims)])


def _placed(corners: Floats, transform: Any) -> Floats:
    """Corners moved by a matrix of the library, whose rows are images of the axes; mirrored faces are turned around."""
    matrix = np.array(transform)
    with np.errstate(all="ignore"):
        placed: Floats = corners @ matrix[:3, :3] + matrix[3, :3]
    return placed[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0 else placed


_ROOMS = ("Ground", "Map", "Obstacles", "Robots", "Pedestrians")
"""Prims below ``/World`` in which stages of irsim have surfaces."""


def main() -> None:
    """Read the request, answer it."""
    serve(_read)


def _read(path: Path, request: dict[str, Any]) -> tuple[Floats, dict[str, Any]]:
    layers = Layers(path, None if request["root"] is None else Path(request["root"]))
    layers.check()
    stage = Usd.Stage.Open(str(path))
    if stage is None:
        raise Refused("it is damaged: no stage can be opened from it")
    layers.check_clips(stage)
    up = str(UsdGeom.GetStageUpAxis(stage)) if request["up"] == "auto" else request["up"].upper()
    scale = float(request["unit"] or UsdGeom.GetStageMetersPerUnit(stage))
    if not 1e-6 <= scale <= 1e6:
        raise Refused(f"its metersPerUnit is {scale:g}", "set metersPerUnit of the stage")
    collector = Collector(int(request["triangles"]))
    triangles = collector.stage(stage) * scale
    if up == "Y":
        triangles = np.stack([triangles[..., 0], -triangles[..., 2], triangles[..., 1]], axis=-1)
    left_out = ", ".join(sorted(collector.left_out))
    notes = [f"prims of these types were left out: {left_out}"] if left_out else []
    if request["unit"] is None and not UsdGeom.StageHasAuthoredMetersPerUnit(stage):
        notes.append(f"it does not say its unit, which is then {scale:g} m; --meters-per-unit gives another")
    notes += layers.notes(stage)
    answer = {"meters_per_unit": scale, "frame": "usd_yup" if up == "Y" else "usd", "notes": notes}
    return triangles, answer | {"own": _own(stage, collector.parts, scale) if up == "Z" else None}


def _own(stage: Any, parts: list[tuple[str, int]], scale: float) -> list[tuple[Any, ...]] | None:
    """Room, name, number of triangles and disk of all parts of a stage that irsim wrote.

    Args:
        stage: The stage, with z up.
        parts: Path and number of triangles of its prims.
        scale: Length of a unit [m].

    Returns:
        They follow one another as the triangles do, with center and radius of a disk [m], None for other shapes; None
        for a stage that another program wrote or changed.
    """
    if "irsim" not in stage.GetRootLayer().customLayerData:
        return None
    result = []
    for path, count in parts:
        room, _, name = path.removeprefix("/World/").partition("/")
        if not count:
            continue
        if room not in _ROOMS or not path.startswith("/World/"):
            return None
        prim = stage.GetPrimAtPath(f"/World/{room}/{name.partition('/')[0]}") if name else None
        title = str(prim.GetCustomDataByKey("irsim:name") or "") if prim else ""
        result.append((room, title, count, _disk(stage.GetPrimAtPath(f"{path}_collision"), scale)))
    return result


def _disk(prim: Any, scale: float) -> tuple[float, float, float] | None:
    """Center and radius of the upright cylinder that collides in place of a mesh [m]; None for other prims."""
    if not prim or not prim.IsA(UsdGeom.Cylinder):
        return None
    time = Usd.TimeCode.EarliestTime()
    matrix = np.array(UsdGeom.XformCache(time).GetLocalToWorldTransform(prim))
    if not np.allclose(matrix[:3, :3] @ matrix[:3, :3].T, np.eye(3)) or not np.isclose(matrix[2, 2], 1):
        return None
    x, y = scale * matrix[3, :2]
    return float(x), float(y), scale * float(UsdGeom.Cylinder(prim).GetRadiusAttr().Get(time))
