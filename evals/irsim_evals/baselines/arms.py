"""The baselines by name: their answers to cases, and these answers graded."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from typing import Any

from irsim_evals.baselines import repair, retrieval
from irsim_evals.cases.store import Instance
from irsim_evals.grader.artefact import Answer
from irsim_evals.grader.limited import grade_all
from irsim_evals.results import Trial, trial_of

__all__ = ["BASELINES", "answers", "run_baseline"]


def _null(instance: Instance) -> Answer:
    """An empty world, whatever is asked: a case that it passes would ask for nothing."""
    return Answer("null", {**instance.case.files, "scenario.yaml": "world: {width: 10, height: 10}\n"}, "Done.")


BASELINES: dict[str, Callable[[Iterable[Instance]], Iterable[Answer]]] = {
    "null": partial[Any](map, _null),
    "retrieval": partial[Any](map, retrieval.answer),
    "repair": repair.answers,
}
"""Name → how it answers requests one after the other. Each is expected to pass more cases than the one before."""


def answers(name: str, instances: Iterable[Instance]) -> Iterator[Answer]:
    """The answers of a baseline to some cases, in their order."""
    return iter(BASELINES[name](instances))


def run_baseline(
    arm: str, instances: Sequence[Instance], progress: Callable[[int, int], None] | None = None
) -> list[Trial]:
    """Let a baseline answer some cases and grade the answers; one is graded while the next is made.

    Further instances of one case count as further attempts at it. ``progress(done, total)`` is called after each answer
    and after each grading.
    """
    made: list[Answer] = []
    trials: list[Trial] = []
    numbers: dict[str, int] = {}

    def report() -> None:
        if progress is not None:
            progress(len(made) + len(trials), 2 * len(instances))

    def pairs() -> Iterator[tuple[Instance, Answer]]:
        for instance, answer in zip(instances, answers(arm, instances), strict=True):
            made.append(answer)
            report()
            yield instance, answer

    for instance, verdict in zip(instances, grade_all(pairs()), strict=True):
        number = numbers[instance.case.id] = numbers.get(instance.case.id, 0) + 1
        trials.append(trial_of(instance, verdict, arm, number=number, reply=made[len(trials)].reply))
        report()
    return trials
