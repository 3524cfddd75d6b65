"""Stages as files: text (``.usda``), binary (``.usdc``) or a package (``.usdz``)."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.state import WorldState, world_state
from irsim.bridges.usd.stage import Heights, Mover, author_scene, new_stage
from irsim.common.angles import wrap
from irsim.common.extras import require
from irsim.common.files import check_new, check_suffix, replacing
from irsim.simulation.scene import SceneDescription

if TYPE_CHECKING:
    from irsim.scenario.limits import Limits

__all__ = ["SUFFIXES", "animate", "export_scene", "make_stage", "save_stage"]


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


SUFFIXES = (".usda", ".usdc", ".usdz")
"""Suffixes of the files that are written."""


def make_stage(
    scene: SceneDescription,
    states: Iterable[WorldState] = (),
    *,
    moving: Iterable[str] | None = None,
    heights: Heights | None = None,
) -> Any:
    """A stage in memory of a scene, whose objects move as states say.

    Args:
        scene: The scene.
        states: States after steps; without any, the stage shows the start.
        moving: Names of the objects that move; default: all that can.
        heights: Heights of solids.

    Raises:
        ExtraError: OpenUSD is not installed.
    """
    require("usd", "pxr")
    stage = new_stage(scene)
    movers = author_scene(stage, scene, heights)
    if moving is not None:
        chosen = set(moving)
        movers = [mover for mover in movers if mover.name in chosen]
    animate(stage, movers, states)
    return stage


def save_stage(stage: Any, target: Path) -> None:
    """Write a stage to a file that its suffix names the format of.

    Raises:
        BridgeError: OpenUSD cannot write it.
        TargetError: The suffix is none of :data:`SUFFIXES`.
    """
    from pxr import Tf, UsdUtils

    check_suffix(target, SUFFIXES)
    try:
        if target.suffix.lower() != ".usdz":
            done = stage.GetRootLayer().Export(str(target))
        else:
            with tempfile.TemporaryDirectory() as folder:
                inner = Path(folder, "scene.usdc")
                done = stage.GetRootLayer().Export(str(inner))
                done = done and UsdUtils.CreateNewUsdzPackage(str(inner), str(target))
    except Tf.ErrorException as error:
        what = f"OpenUSD cannot write {target.name}: {error}"
        raise BridgeError("bridge-failed", what, "check permissions and the space left") from None
    if not done:
        raise BridgeError(
            "bridge-failed", f"OpenUSD cannot write {target.name}", "check permissions and the space left"
        )


def export_scene(
    scenario: str | Path,
    out: str | Path,
    *,
    seed: int = 0,
    heights: Heights | None = None,
    overwrite: bool = False,
    limits: Limits | None = None,
) -> Path:
    """Write the start of a scenario, which need not have been run, as a stage.

    Args:
        scenario: File of the scenario.
        out: File to write, with one of the suffixes :data:`SUFFIXES`.
        seed: Seed of what the scenario draws at random.
        heights: Heights of solids.
        overwrite: Replace a file that exists.
        limits: Limits of the reader of the scenario.

    Raises:
        ExtraError: OpenUSD is not installed.
        ScenarioError: The scenario has errors.
        TargetError: The file has another suffix, or exists.
    """
    from irsim.env import Env
    from irsim.objects.describe import agent_rows, describe_scene
    from irsim.scenario.open import open_scenario

    target = Path(out)
    require("usd", "pxr")
    check_suffix(target, SUFFIXES)
    check_new(target, overwrite=overwrite)
    resolved, _ = open_scenario(scenario, limits=limits)
    env = Env(resolved, seed=seed, headless=True, log_level="ERROR")
    try:
        scene = describe_scene(env.simulation)
        start = world_state(env.simulation, agent_rows(env.simulation))
    finally:
        env.end(ending_time=0.0)
    with replacing(target) as path:
        save_stage(make_stage(scene, [start], heights=heights), path)
    return target
