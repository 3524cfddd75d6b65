"""``irsim.make``: a scenario file as an environment, flat or in space."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from irsim.env.env_base import Env

__all__ = ["make"]


def make(
    world_name: str | Path | None = None, projection: str | None = None, step_mode: str | None = None, **kwargs: Any
) -> Env:
    """Open a scenario file as an environment.

    Args:
        world_name: YAML file; searched as given, beside the script, in the current directory. Default: the name of the
            running script with ``.yaml``.
        projection: ``"2d"`` (default) or ``"3d"``: the same simulation, drawn in space.
        step_mode: ``"internal"`` or ``"external"``, over the file's.
        **kwargs: Those of :class:`Env`: display, headless, save_ani, seed, strict, log_level, …

    Raises:
        ScenarioNotFoundError: No such file; names the places searched and near matches.
        ScenarioError: The file cannot be used; holds every problem with its line and fix.
        TypeError: Unknown keyword.
    """
    chosen = (projection or "2d").lower()
    if chosen == "3d":
        from irsim.env.env_base3d import EnvBase3D

        return EnvBase3D(world_name, step_mode=step_mode, **kwargs)
    if chosen != "2d":
        raise ValueError(f"unknown projection {projection!r}: choose '2d' or '3d'")
    return Env(world_name, step_mode=step_mode, **kwargs)
