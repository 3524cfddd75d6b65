"""The proof itself: golds, rewrites, mutants and null agents of every case, and assertions that tell nothing."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from irsim_evals.cases.store import PUBLISHED, Instance, Store, case_ids
from irsim_evals.grader.artefact import Answer
from irsim_evals.grader.grade import grade
from irsim_evals.grader.limited import SECONDS, LimitError, run_all
from irsim_evals.grader.outcome import NOT_REACHED, Outcome, Verdict
from irsim_evals.proof.oracle.opinions import opinions
from irsim_evals.proof.trials import RIGHT, Kind, Trial, changes_of, kind_of, trials_of

__all__ = ["Proof", "as_case_rows", "as_rows", "idle_assertions", "prove", "tried"]

_SECOND_SHARE = 0.25
"""Share of the trials that are also given to the second implementation."""
_QUICK_SHARE = 0.05
"""Share of rewrites, mutants and null agents that the quick proof tries."""
_ERRORS: dict[str, tuple[Kind, ...]] = {
    "false accepts": ("pinned mutant", "broken mutant", "attack", "null"),
    "false accepts of attacks": ("attack",),
    "false rejects": RIGHT,
}
"""Kind of wrong verdicts → trials that can have one."""
_EMPTY = Answer("empty", {"scenario.yaml": "world: {width: 10, height: 10}\n"})
_BATCH = 40
"""Number of changed answers that are graded before it is looked whether any assertion is left."""
_MAX_TRIALS = 200
"""Number of changed answers that are graded at most."""


@dataclass
class Proof:
    """Results of a proof.

    Attributes:
        done: (kind, operator) → number of trials, and of those graded wrongly.
        wrong: Trials that were graded wrongly, with their verdicts.
        unjudged: Trials without a verdict, because the grading used up its time or its process died, with the reason.
            They are neither accepted nor rejected.
        left_out: Mutants of facts that no case pins or leaves free: (operator) → number; mutants that cases waive
            are under ``waived``.
        by_case: (case, kind) → number of trials.
        compared: Predicate → number of assertions that the second implementation has judged, too.
        disagreements: Assertions that it has judged otherwise: trial, predicate, and outcome of the grader.
    """

    done: Counter[tuple[str, str]] = field(default_factory=Counter)
    wrong: list[tuple[Trial, Verdict]] = field(default_factory=list)
    unjudged: list[tuple[Trial, str]] = field(default_factory=list)
    left_out: Counter[str] = field(default_factory=Counter)
    by_case: Counter[tuple[str, str]] = field(default_factory=Counter)
    compared: Counter[str] = field(default_factory=Counter)
    disagreements: list[tuple[Trial, str, Outcome]] = field(default_factory=list)

    @property
    def rates(self) -> dict[str, tuple[int, int]]:
        """Kind of wrong verdicts → their number, and the number of trials that could have had one."""
        return {name: self._rate(kinds) for name, kinds in _ERRORS.items()}

    def _rate(self, kinds: tuple[Kind, ...]) -> tuple[int, int]:
        count = sum(number for (kind, _), number in self.done.items() if kind in kinds)
        return sum(trial.kind in kinds for trial, _ in self.wrong), count


def prove(
    ids: list[str] | None = None,
    *,
    store: Store = PUBLISHED,
    quick: bool = False,
    seed: int = 0,
    progress: Callable[[int, int], None] | None = None,
) -> Proof:
    """Try the grader on answers of which it is known whether they are right.

    Args:
        ids: Cases; default: all.
        store: Where they and their golds lie.
        quick: All golds, and a random twentieth of the rest.
        seed: Seed of the choice, and of one fresh instance of each case.
        progress: Callback ``(done, total)``.
    """
    proof = Proof()
    choice = random.Random(seed)
    keep = (lambda: choice.random() < _QUICK_SHARE) if quick else (lambda: True)
    names = ids if ids is not None else case_ids(store, sets=True)
    trials: list[Trial] = []
    rng = random.Random(f"second {seed}")

    def jobs() -> Iterator[tuple[Trial, bool]]:
        """Each trial is graded while the next ones are still written; all are there before the first result."""
        for name in names:
            for trial in trials_of(name, proof.left_out, seed, keep, store):
                trials.append(trial)
                yield trial, rng.random() < _SECOND_SHARE

    results = run_all(tried, jobs(), None, 2 * SECONDS, "grading")  # a trial is also compared, and graded twice
    for number, result in enumerate(results):
        _note(proof, trials[number], result)
        if progress is not None:
            progress(number + 1, len(trials))
    return proof


def tried(trial: Trial, second: bool) -> tuple[Kind, Any, dict[str, bool]] | None:
    """The kind of a trial, the verdict on its answer, and what the second implementation thinks of some assertions.

    None for a mutant of facts that the case neither pins nor leaves free.
    """
    kind = kind_of(trial) if trial.kind == "mutant" else trial.kind
    if kind is None:
        return None
    verdict = grade(trial.instance, trial.answer, whole=False)
    reached = {outcome.assertion for outcome in verdict.outcomes if outcome.observed != NOT_REACHED}
    judged = opinions(trial.instance, trial.answer, reached) if second and "loads" in reached else {}
    return kind, verdict.model_dump(mode="json"), judged


def _note(proof: Proof, trial: Trial, result: Any) -> None:
    """Add what came out of one trial."""
    if result is None:
        proof.left_out[trial.operator] += 1
        return
    if isinstance(result, LimitError):
        proof.unjudged.append((trial, str(result)))
        return
    trial, verdict, second = replace(trial, kind=result[0]), Verdict.model_validate(result[1]), result[2]
    proof.done[trial.kind, trial.operator] += 1
    proof.by_case[trial.case, trial.kind] += 1
    if verdict.strict != trial.right:
        proof.wrong.append((trial, verdict))
    said = {item.id: item.predicate.name for item in trial.instance.case.assertions().values()}
    for outcome in verdict.outcomes:
        if outcome.assertion in second and outcome.observed != NOT_REACHED:
            predicate = said[outcome.assertion]
            proof.compared[predicate] += 1
            if second[outcome.assertion] != outcome.passed:
                proof.disagreements.append((trial, predicate, outcome))


def as_rows(proof: Proof) -> list[dict[str, Any]]:
    """One row for each kind and operator: how many trials, how many graded wrongly."""
    bad: Counter[tuple[str, str]] = Counter((trial.kind, trial.operator) for trial, _ in proof.wrong)
    return [
        {"kind": kind, "operator": operator, "trials": number, "wrong": bad[kind, operator]}
        for (kind, operator), number in sorted(proof.done.items())
    ]


def as_case_rows(proof: Proof) -> list[dict[str, Any]]:
    """One row for each case: how many rewrites, mutants and null agents were tried."""
    bad: Counter[str] = Counter(trial.case for trial, _ in proof.wrong)
    return [
        {
            "case": case,
            "rewrites": proof.by_case[case, "rewrite"],
            "mutants": sum(
                number for (name, kind), number in proof.by_case.items() if name == case and "mutant" in kind
            ),
            "attacks": proof.by_case[case, "attack"],
            "null": proof.by_case[case, "null"],
            "wrong": bad[case],
        }
        for case in sorted({case for case, _ in proof.by_case})
    ]


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
