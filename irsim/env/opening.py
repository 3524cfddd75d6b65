"""``irsim.make``: a scenario file becomes an environment, drawn in the plane or in space."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from irsim.env.env_base import Env
from irsim.env.old.env_base3d import EnvBase3D

__all__ = ["make"]


def make(
    world_name: str | Path | None = None, projection: str | None = None, step_mode: str | None = None, **kwargs: Any
) -> Env:
    """Open a scenario file as an environment.

    Args:
        world_name: YAML file; it is searched as given, beside the script, and in the current directory. By default it
            has the name of the running script with the suffix ``.yaml``.
        projection: ``"2d"`` (default) or ``"3d"``, which draws the same simulation in space.
        step_mode: ``"internal"`` or ``"external"``, in place of the value in the file.
        **kwargs: Other arguments of :class:`Env`: display, headless, save_ani, seed, strict, log_level, policy, …

    Raises:
        ScenarioNotFoundError: The file does not exist; the error lists the folders searched and similar names.
        ScenarioError: The file is not valid; the error holds every problem with its line and fix.
        TypeError: A keyword is not known.
    """
    chosen = (projection or "2d").lower()
    if chosen == "3d":
        return EnvBase3D(world_name, step_mode=step_mode, **kwargs)
    if chosen != "2d":
        raise ValueError(f"unknown projection {projection!r}: choose '2d' or '3d'")
    return Env(world_name, step_mode=step_mode, **kwargs)
