"""Assertions that tell nothing: an empty world fulfils them, or no change of the right answers breaks them."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator, Sequence

from irsim_evals.cases.store import Instance
from irsim_evals.grader.artefact import Answer
from irsim_evals.grader.grade import grade
from irsim_evals.grader.limited import SECONDS, LimitError, run_all
from irsim_evals.grader.outcome import NOT_REACHED
from irsim_evals.proof.trials import changes_of

__all__ = ["idle_assertions"]

_EMPTY = Answer("empty", {"scenario.yaml": "world: {width: 10, height: 10}\n"})
_BATCH = 40
"""Number of changed answers that are graded before it is looked whether any assertion is left."""
_MAX_TRIALS = 200
"""Number of changed answers that are graded at most."""


def idle_assertions(instance: Instance, golds: Sequence[Answer]) -> Iterator[tuple[str, str]]:
    """Assertions that are reported to the author of a case: id, and ``empty_holds`` or ``unbroken``.

    Args:
        instance: The case.
        golds: Its right answers.
    """
    left = [item.id for item in instance.case.assertions().values() if item.when != "unbuilt"]
    empty = _broken(instance, _EMPTY)
    yield from ((name, "empty_holds") for name in left if name not in empty)
    trials = [trial for gold in golds for trial in changes_of(instance, gold, Counter()) if trial.kind != "rewrite"]
    random.Random(0).shuffle(trials)
    for begin in range(0, min(len(trials), _MAX_TRIALS), _BATCH):
        jobs = [(instance, trial.answer) for trial in trials[begin : begin + _BATCH]]
        done = run_all(_broken, jobs, None, SECONDS, "grading") if left else []
        broken = {name for names in done if not isinstance(names, LimitError) for name in names}
        left = [name for name in left if name not in broken]
    yield from ((name, "unbroken") for name in left)


def _broken(instance: Instance, answer: Answer) -> list[str]:
    """The assertions that an answer does not fulfil, as far as they were reached."""
    return [one.assertion for one in grade(instance, answer).failed() if one.observed != NOT_REACHED]
