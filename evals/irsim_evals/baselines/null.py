"""``null``: an empty world for every request. A case that it passes would ask for nothing."""

from __future__ import annotations

from irsim_evals.baselines.task import Task
from irsim_evals.cases.store import Answer

__all__ = ["answer"]


def answer(task: Task) -> Answer:
    """An empty world, whatever is asked."""
    return Answer("null", {**(task.files or {}), "scenario.yaml": "world: {width: 10, height: 10}\n"}, "Done.")
