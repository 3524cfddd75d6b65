"""States as time samples of prims: place, continuous heading, and whether an object is in the world."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from irsim.bridges.state import WorldState
from irsim.bridges.usd.stage import Mover
from irsim.common.angles import wrap

__all__ = ["animate"]


class _Track:
    """Samples of one prim: one for each step, as interpolation would round; a value that never changes has one."""

    def __init__(self, layer: Any, mover: Mover, height: float = 0.0) -> None:
        self._layer, self._height = layer, height
        self._translate = f"{mover.path}.xformOp:translate"
        self._rotate = f"{mover.path}.xformOp:rotateZ"
        self._visibility = f"{mover.path}.visibility"
        self._yaw: float | None = None
        self._present: bool | None = None
        self._same: dict[str, tuple[Any, list[float]]] = {}
        self._changed: set[str] = set()

    def add(self, step: float, pose: Sequence[float]) -> None:
        """Add where the object is after a step; NaN while it is not in the world."""
        x, y, yaw = pose
        present = math.isfinite(x)
        if present != self._present:
            self._present = present
            self._layer.SetTimeSample(self._visibility, step, "inherited" if present else "invisible")
        if not present:
            return
        before = self._yaw
        self._yaw = yaw if before is None else before + float(wrap(yaw - before))
        self._sample(self._translate, step, (x, y))
        self._sample(self._rotate, step, self._yaw)

    def _sample(self, path: str, step: float, value: Any) -> None:
        if path not in self._changed:
            first, steps = self._same.setdefault(path, (value, []))
            if value == first:
                steps.append(step)
                if len(steps) > 1:
                    return
            else:
                self._changed.add(path)
                for earlier in self._same.pop(path)[1][1:]:
                    self._write(path, earlier, first)
        self._write(path, step, value)

    def _write(self, path: str, step: float, value: Any) -> None:
        from pxr import Gf

        is_place = path is self._translate
        written = Gf.Vec3d(*value, self._height) if is_place else math.degrees(value)
        self._layer.SetTimeSample(path, step, written)


def animate(stage: Any, movers: Iterable[Mover], states: Iterable[WorldState]) -> int:
    """Write time samples; one time code is one step.

    Args:
        stage: A stage with the prims of the movers.
        movers: The objects.
        states: States in the order of their steps.

    Returns:
        The number of states.
    """
    from pxr import Sdf, UsdGeom

    movers, layer = list(movers), stage.GetRootLayer()
    for mover in movers:
        UsdGeom.Imageable(stage.GetPrimAtPath(mover.path)).CreateVisibilityAttr()
    tracks = [_Track(layer, mover) for mover in movers]
    first = last = None
    count = 0
    with Sdf.ChangeBlock():
        for state in states:
            first = state.step if first is None else first
            last, count = state.step, count + 1
            poses = np.asarray(state.pose).tolist()
            for mover, track in zip(movers, tracks, strict=True):
                track.add(float(state.step), poses[mover.index])
    if first is not None and last is not None:
        stage.SetStartTimeCode(first)
        stage.SetEndTimeCode(last)
    return count
