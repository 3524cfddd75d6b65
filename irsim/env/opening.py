"""``irsim.make``: a scenario file becomes an environment, drawn in the plane or in space."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.common.keywords import answers_misspelt
from irsim.diagnostics.errors import InputError
from irsim.env.env_base import Env
from irsim.env.old.env_base3d import EnvBase3D
from irsim.scenario.resolve.resolved import ResolvedScenario

if TYPE_CHECKING:
    from irsim.policies.catalog import PolicySource

__all__ = ["make"]


@answers_misspelt
def make(
    world_name: str | Path | ResolvedScenario | None = None,
    projection: str | None = None,
    step_mode: str | None = None,
    *,
    display: bool = True,
    disable_all_plot: bool = False,
    save_ani: bool = False,
    ani_kwargs: Mapping[str, Any] | None = None,
    full: bool = False,
    log_file: str | Path | None = None,
    log_level: str = "INFO",
    seed: int | None = None,
    headless: bool = False,
    strict: bool = False,
    policy: PolicySource | None = None,
) -> Env:
    """Open a scenario file as an environment.

    Args:
        world_name: YAML file; it is searched as given, beside the script, and in the current directory. By default it
            has the name of the running script with the suffix ``.yaml``.
        projection: ``"2d"`` (default) or ``"3d"``, which draws the same simulation in space.
        step_mode: ``"internal"`` or ``"external"``, in place of the value in the file.
        display: Show a window if there is a screen; each ``env.render()`` updates it, and the first one opens it.
        disable_all_plot: Draw nothing at all; ``headless`` has the same effect.
        save_ani: Keep a frame at each sampled ``render`` and write the animation in ``end``.
        ani_kwargs: Default options of the animation.
        full: Show the window full-screen.
        log_file: File to log to as well.
        log_level: Lowest level that is logged.
        seed: Seed in place of ``world.seed``; without both it is drawn from fresh entropy. ``env.seed`` returns it.
        headless: Draw nothing at all.
        strict: Treat what IR-SIM would ignore (misspelt keys, unknown behaviors) as errors.
        policy: The policy that drives the robots instead of their behaviors; see :meth:`Env.set_policy`.

    Raises:
        ScenarioNotFoundError: The file does not exist; the error lists the folders searched and similar names.
        ScenarioError: The file is not valid; the error holds every problem with its line and fix.
        TypeError: A keyword is not known; the error names the nearest one.
    """
    chosen = (projection or "2d").lower()
    if chosen not in ("2d", "3d"):
        raise InputError(f"unknown projection {projection!r}", "choose '2d' or '3d'")
    kind = EnvBase3D if chosen == "3d" else Env
    return kind(
        world_name, display, disable_all_plot, save_ani, ani_kwargs, full, log_file, log_level, seed, step_mode,
        headless, strict=strict, policy=policy,
    )  # fmt: skip
