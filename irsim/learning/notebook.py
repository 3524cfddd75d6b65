"""Environments of learning libraries in a notebook: a picture of the first world, and facts."""

from __future__ import annotations

from typing import Any

from irsim.common.notebook import facts, section
from irsim.env.notebook import NO_TRACKS, world_picture

__all__ = ["worlds_html"]


def worlds_html(worlds: Any, kind: str) -> str:
    """The facts of the worlds of a task, and a picture of the first one.

    Args:
        worlds: The worlds.
        kind: Name of the environment.
    """
    known = {
        "scenario": worlds.scenario.name,
        "worlds": worlds.n,
        "learners in each": worlds.learners,
        "numbers of an observation": worlds.buffer().shape[-1],
        "numbers of an action": worlds.width,
    }
    return section(f"{kind} of {worlds.task.task}: world 0", world_picture(worlds.simulation, NO_TRACKS), facts(known))
