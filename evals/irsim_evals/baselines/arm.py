"""Run a baseline: its answers to some cases, graded."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from irsim_evals.baselines import answers
from irsim_evals.cases.instance import Instance
from irsim_evals.cases.store import Answer
from irsim_evals.grader.limited import grade_all
from irsim_evals.results import Trial, trial_of

__all__ = ["run_baseline"]


def run_baseline(
    arm: str, instances: Sequence[Instance], progress: Callable[[int, int], None] | None = None
) -> list[Trial]:
    """Let a baseline answer some cases and grade the answers; one is graded while the next is made.

    Args:
        arm: Name of the baseline.
        instances: The cases; further instances of the same case count as further attempts at it.
        progress: Callback ``(done, total)``; an answer and its grading count as one step each.
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
