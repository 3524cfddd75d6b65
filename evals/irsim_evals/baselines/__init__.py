"""Baselines: programs that answer cases without a model. They show what the score measures.

Each is a deterministic function of the request alone: prompt, later turns, and the files that the folder starts with.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import Any

from irsim_evals.baselines import null, repair, retrieval, rules
from irsim_evals.baselines.task import Task, task_of
from irsim_evals.cases.instance import Instance
from irsim_evals.cases.store import Answer

__all__ = ["BASELINES", "answer", "answers"]

BASELINES: dict[str, Callable[[Iterable[Task]], Iterable[Answer]]] = {
    "null": partial[Any](map, null.answer),
    "retrieval": partial[Any](map, retrieval.answer),
    "rules": partial[Any](map, rules.answer),
    "repair": repair.answers,
}
"""Name → how it answers requests one after the other. Each is expected to pass more cases than the one before."""


def answers(name: str, instances: Iterable[Instance]) -> Iterator[Answer]:
    """The answers of a baseline to some cases, in their order.

    Raises:
        KeyError: No baseline has that name.
    """
    return iter(BASELINES[name](task_of(instance) for instance in instances))


def answer(name: str, instance: Instance) -> Answer:
    """The answer of a baseline to one case.

    Raises:
        KeyError: No baseline has that name.
    """
    return next(answers(name, [instance]))
