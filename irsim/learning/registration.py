"""Registers the bundled tasks with Gymnasium."""

from __future__ import annotations

from importlib.util import find_spec

from irsim.learning.tasks.files import TASKS

__all__ = ["environment_id", "register_environments"]

_VERSION = 0


def environment_id(task: str) -> str:
    """The id of a bundled task: ``irsim/GoalLidar-v0`` for ``goal_lidar``."""
    return f"irsim/{''.join(word.capitalize() for word in task.split('_'))}-v{_VERSION}"


def register_environments() -> None:
    """Register the bundled tasks, and ``irsim/Task-v0`` with the argument ``task``; nothing without Gymnasium."""
    if find_spec("gymnasium") is None:
        return
    import gymnasium  # an import of what only some have installed

    entries = {"entry_point": "irsim.learning.gym_env:Env", "vector_entry_point": "irsim.learning.vector_env:VectorEnv"}
    known = gymnasium.registry
    for task in TASKS.names():
        if environment_id(task) not in known:
            gymnasium.register(environment_id(task), kwargs={"task": str(TASKS.bundled(task))}, **entries)
    if (general := f"irsim/Task-v{_VERSION}") not in known:
        gymnasium.register(general, **entries)
