"""Stages as files: text (``.usda``), binary (``.usdc``) or a package (``.usdz``)."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.bridges.base import BridgeError
from irsim.bridges.state import WorldState, world_state
from irsim.common.extras import require
from irsim.common.files import check_new, check_suffix, replacing
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
        fix = "check permissions and the space left"
        raise BridgeError("bridge-failed", f"OpenUSD cannot write {target.name}", fix)


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
