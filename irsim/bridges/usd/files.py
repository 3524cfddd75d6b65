"""Stages as files: text (``.usda``), binary (``.usdc``) or a package (``.usdz``)."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import is_zipfile

from irsim.bridges.base import BridgeError
from irsim.bridges.state import WorldState, world_state
from irsim.common.extras import require
from irsim.common.files import check_new, check_suffix, replacing
from irsim.common.text import clean
from irsim.env import Env
from irsim.objects.describe import agent_rows, describe_scene
from irsim.scenario.limits import Limits
from irsim.scenario.open import open_scenario
from irsim.simulation.scene import SceneDescription

if TYPE_CHECKING:
    from irsim.bridges.usd.stage import Heights

__all__ = ["SUFFIXES", "export_scene", "make_stage", "save_stage"]


SUFFIXES = (".usda", ".usdc", ".usdz")
"""Suffixes of the files that are written."""
_LEAST_SPACE = 1 << 20
"""Space below which a disk counts as full, if OpenUSD cannot write to it [bytes]."""


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
    from irsim.bridges.usd.stage import animate, author_scene, new_stage

    stage = new_stage(scene)
    movers = author_scene(stage, scene, heights)
    if moving is not None:
        chosen = set(moving)
        movers = [mover for mover in movers if mover.name in chosen]
    animate(stage, movers, states)
    return stage


def save_stage(stage: Any, target: Path) -> None:
    """Write a stage to a file that its suffix names the format of.

    OpenUSD does not say that a disk is full, and takes a part of a package for a whole one. So it writes to a folder of
    its own, from which the file is copied.

    Raises:
        BridgeError: OpenUSD cannot write it.
        OSError: The file cannot be written.
        TargetError: The suffix is none of :data:`SUFFIXES`.
    """
    from pxr import Tf, UsdUtils

    check_suffix(target, SUFFIXES)
    suffix = target.suffix.lower()
    with tempfile.TemporaryDirectory(prefix="irsim-") as folder:
        written = Path(folder, f"scene{suffix if suffix != '.usdz' else '.usdc'}")
        try:
            done = stage.GetRootLayer().Export(str(written))
            if suffix == ".usdz":
                inner, written = written, written.with_suffix(suffix)
                done = done and UsdUtils.CreateNewUsdzPackage(str(inner), str(written)) and is_zipfile(written)
        except Tf.ErrorException:
            done = False
        if not done:
            code = "disk-full" if shutil.disk_usage(folder).free < _LEAST_SPACE else "bridge-failed"
            what = f"OpenUSD cannot write {target.name} by way of {clean(tempfile.gettempdir(), 200)}"
            raise BridgeError(code, what, "check permissions and the space left there")
        shutil.copyfile(written, target)


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
