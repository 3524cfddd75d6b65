"""The proof itself: golds, rewrites, mutants and null agents of every case, and one table of what came out."""

from __future__ import annotations

import random
import re
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import yaml

from irsim.bundled.templates.store import load, names
from irsim.diagnostics.errors import IrsimError
from irsim.scenario.read import read
from irsim.scenario.yaml.comments import places_of_comments
from irsim.scenario.yaml.document import load_text
from irsim_evals.cases.instance import Instance
from irsim_evals.cases.store import Answer, case_ids, case_of, golds_of
from irsim_evals.grader.artefact import find_scenario
from irsim_evals.grader.grade import LIMITS, failed_verdict, grade
from irsim_evals.grader.limited import SECONDS, LimitError, run_all
from irsim_evals.grader.material import write_files
from irsim_evals.grader.outcome import NOT_REACHED, Verdict
from irsim_evals.grader.scene import Scene, open_scene
from irsim_evals.proof.changes import changed_facts, touches
from irsim_evals.proof.mutants import mutants_of
from irsim_evals.proof.mutants_of_answers import mutants_of_answer
from irsim_evals.proof.mutants_of_text import mutants_of_text
from irsim_evals.proof.oracle.opinions import opinions
from irsim_evals.proof.rewrites import rewrites_of

__all__ = ["Proof", "Trial", "prove", "trials_of"]

Kind = Literal["gold", "rewrite", "pinned mutant", "broken mutant", "free mutant", "null"]
Runner = Callable[[Callable[..., Any], Iterable[tuple[Any, ...]]], Iterator[Any]]
"""Calls a function for each tuple of arguments."""
_NEVER_RIGHT = ("on_top", "goal_outside")
"""Operators whose mutants break what must hold in every scenario."""
_SECOND_SHARE = 0.25
"""Share of the trials that are also given to the second implementation."""
_QUICK_SHARE = 0.1
"""Share of rewrites, mutants and null agents that the quick proof tries."""


@dataclass(frozen=True)
class Trial:
    """One answer of which it is known whether it is right.

    Attributes:
        case, gold: Case and gold that it was made from.
        kind: What it is.
        operator: What made it.
        what: What was changed.
        right: Whether the grader must accept it.
        instance, answer: What is graded.
    """

    case: str
    gold: str
    kind: Kind
    operator: str
    what: str
    right: bool
    instance: Instance = field(repr=False)
    answer: Answer = field(repr=False)


@dataclass(frozen=True)
class Disagreement:
    """An assertion that the second implementation judges otherwise.

    Attributes:
        trial: The answer.
        assertion, predicate: Its id in the case, and what it says.
        passed: What the grader says; the second implementation says the opposite.
        observed: What the grader observed.
    """

    trial: Trial
    assertion: str
    predicate: str
    passed: bool
    observed: str


@dataclass
class Proof:
    """What came out.

    Attributes:
        done: (kind, operator) → number of trials, and of those graded wrongly.
        wrong: Trials that were graded wrongly, with their verdicts.
        left_out: Mutants of facts that no case pins or leaves free: (operator) → number; those that cases waive are
            under ``waived``.
        by_case: (case, kind) → number of trials.
        compared: Predicate → number of assertions that the second implementation has judged, too.
        disagreements: Those that it has judged otherwise.
    """

    done: Counter[tuple[str, str]] = field(default_factory=Counter)
    wrong: list[tuple[Trial, Verdict]] = field(default_factory=list)
    left_out: Counter[str] = field(default_factory=Counter)
    by_case: Counter[tuple[str, str]] = field(default_factory=Counter)
    compared: Counter[str] = field(default_factory=Counter)
    disagreements: list[Disagreement] = field(default_factory=list)

    def rate(self, *kinds: str) -> tuple[int, int]:
        """Number of wrong verdicts and of trials of some kinds."""
        count = sum(number for (kind, _), number in self.done.items() if kind in kinds)
        return sum(trial.kind in kinds for trial, _ in self.wrong), count

    @property
    def false_accepts(self) -> tuple[int, int]:
        """Wrong answers that were accepted, of all wrong answers."""
        return self.rate("pinned mutant", "broken mutant", "null")

    @property
    def false_rejects(self) -> tuple[int, int]:
        """Right answers that were rejected, of all right answers."""
        return self.rate("gold", "rewrite", "free mutant")


def _in_limited_processes(work: Callable[..., Any], jobs: Iterable[tuple[Any, ...]]) -> Iterator[Any]:
    return run_all(work, jobs, None, SECONDS, "grading")


def prove(
    ids: list[str] | None = None,
    *,
    quick: bool = False,
    seed: int = 0,
    progress: Callable[[int, int], None] | None = None,
    runner: Runner = _in_limited_processes,
) -> Proof:
    """Try the grader on answers of which it is known whether they are right.

    Args:
        ids: Cases; default: all.
        quick: All golds, and a random tenth of the rest.
        seed: Seed of the choice, and of one fresh instance of each case.
        progress: Callback ``(done, total)``.
        runner: What does the gradings, in their order.
    """
    proof = Proof()
    choice = random.Random(seed)
    keep = (lambda: choice.random() < _QUICK_SHARE) if quick else (lambda: True)
    trials = [trial for case_id in ids or case_ids() for trial in trials_of(case_id, proof.left_out, seed, keep)]
    rng = random.Random(f"second {seed}")
    jobs = [(trial.instance, trial.answer, rng.random() < _SECOND_SHARE) for trial in trials]
    for number, result in enumerate(runner(_try, jobs)):
        _note(proof, trials[number], result)
        if progress is not None:
            progress(number + 1, len(trials))
    return proof


def _try(instance: Instance, answer: Answer, second: bool) -> tuple[Any, dict[str, bool]]:
    """The verdict on an answer, and what the second implementation thinks of some assertions."""
    verdict = grade(instance, answer)
    loads = any(outcome.assertion == "loads" and outcome.passed for outcome in verdict.outcomes)
    return verdict.model_dump(mode="json"), opinions(instance, answer) if second and loads else {}


def _note(proof: Proof, trial: Trial, result: Any) -> None:
    """Add what came out of one trial."""
    if isinstance(result, LimitError):
        verdict, second = failed_verdict(trial.instance, trial.answer, "gradable", "parse", str(result)), {}
    else:
        verdict, second = Verdict.model_validate(result[0]), result[1]
    proof.done[trial.kind, trial.operator] += 1
    proof.by_case[trial.case, trial.kind] += 1
    if verdict.strict != trial.right or isinstance(result, LimitError):  # a grader that dies is never right
        proof.wrong.append((trial, verdict))
    case: Any = trial.instance.case
    said = {item.id: item.predicate.name for item in (*case.check, *(a for plan in case.episodes for a in plan.check))}
    for outcome in verdict.outcomes:
        if outcome.assertion in second and outcome.observed != NOT_REACHED:
            predicate = said[outcome.assertion]
            proof.compared[predicate] += 1
            if second[outcome.assertion] != outcome.passed:
                proof.disagreements.append(
                    Disagreement(trial, outcome.assertion, predicate, outcome.passed, outcome.observed)
                )


def trials_of(
    case_id: str, left_out: Counter[str], seed: int = 0, keep: Callable[[], bool] = lambda: True
) -> Iterator[Trial]:
    """The trials of one case: golds as published and of a fresh instance, then changes of the golds as published.

    Args:
        case_id: The case.
        left_out: Counts mutants that are no trials.
        seed: Seed of the fresh instance.
        keep: Asked for each change whether it is tried.
    """
    for fresh in (None, seed + 1):
        instance = case_of(case_id, fresh)
        for gold in golds_of(instance):
            what = "as published" if fresh is None else f"instance {fresh}"
            yield Trial(case_id, gold.name, "gold", "gold", what, True, instance, gold)
    instance = case_of(case_id)
    for gold in golds_of(instance):
        yield from _changed(case_id, instance, gold, left_out, keep)
    yield from (trial for trial in _null(case_id, instance) if keep())


def _changed(
    case_id: str, instance: Instance, gold: Answer, left_out: Counter[str], keep: Callable[[], bool]
) -> Iterator[Trial]:
    found = find_scenario(gold, instance.case.files)
    words = _changed_words(case_id, instance, gold, found[0] if found else None, left_out)
    yield from (trial for trial in words if keep())
    if found is None:
        return
    name, text = found
    scene = _scene(text, gold, instance.case.seeds[0])
    if scene is None:
        return

    def answer(new: str) -> Answer:
        return replace(gold, files={**gold.files, name: new})

    for operator, new in rewrites_of(instance.case, name, text, scene):
        if keep():
            yield Trial(case_id, gold.name, "rewrite", operator, operator, True, instance, answer(new))
    for operator, what, new in _mutants(text, edited=name in instance.case.files):
        kind = _kind(instance, gold, scene, operator, what, new, left_out) if keep() else None
        if kind is not None:
            yield Trial(case_id, gold.name, kind, operator, what, kind == "free mutant", instance, answer(new))


def _mutants(text: str, edited: bool) -> Iterator[tuple[str, str, str]]:
    """Operator, what was changed and text of each mutant of a scenario; those of an edited file keep its comments."""
    comments = _comments(text) if edited else ""
    for mutant in mutants_of(yaml.safe_load(text)):
        new = yaml.safe_dump(mutant.data, sort_keys=False, allow_unicode=True)
        yield mutant.operator, mutant.what, new + comments
    if edited:
        yield from (("number_in_text", what, new) for what, new, _ in mutants_of_text(text))


def _kind(
    instance: Instance, gold: Answer, scene: Scene, operator: str, what: str, text: str, left_out: Counter[str]
) -> Kind | None:
    """Whether a mutant must be rejected or accepted; None if the case does not say."""
    if _is_waived(instance, operator, what):
        left_out["waived"] += 1
        return None
    world = _scene(text, gold, instance.case.seeds[0])
    if world is None:
        return "broken mutant"
    changed = changed_facts(scene, world)
    if operator in _NEVER_RIGHT and not (operator == "on_top" and instance.case.overlap):
        return "pinned mutant"
    if touches(instance.case, (scene, world), changed, instance.case.pins):
        return "pinned mutant"
    if changed and changed == touches(instance.case, (scene, world), changed, instance.case.free):
        return "free mutant"
    left_out[operator] += 1
    return None


def _comments(text: str) -> str:
    """The comments of a file on lines of their own, so that a mutant of an edited file fails for what it changes and
    not for comments that were lost when it was written."""
    return "".join(f"# {comment}\n" for comment, _ in places_of_comments(load_text(text)))


def _changed_words(
    case_id: str, instance: Instance, gold: Answer, main: str | None, left_out: Counter[str]
) -> Iterator[Trial]:
    """Mutants of the reply and of the text. What a reply says is free unless the case pins it."""
    pinned = {fact for pin in instance.case.pins if pin.of in ("reply", "text") for fact in pin.facts}
    for operator, what, fact, answer in mutants_of_answer(instance, gold, main):
        if _is_waived(instance, operator, what):
            left_out["waived"] += 1
        elif fact in ("files", "edit") or fact in pinned:
            yield Trial(case_id, gold.name, "pinned mutant", operator, what, False, instance, answer)
        elif fact in ("reply", "replies") and main is not None:
            yield Trial(case_id, gold.name, "free mutant", operator, what, True, instance, answer)
        else:
            left_out[operator] += 1


def _is_waived(instance: Instance, operator: str, what: str) -> bool:
    return any(item.operator == operator and re.search(item.what, what) for item in instance.case.waived)


def _null(case_id: str, instance: Instance) -> Iterator[Trial]:
    """Answers of agents that do nothing for the case."""
    empty = "world: {width: 10, height: 10}\n"
    answers = {
        "empty world": Answer("empty", {"scenario.yaml": empty}),
        "nothing": Answer("nothing", dict(instance.case.files)),
        "claims": Answer("claims", {"scenario.yaml": empty}, "All assertions passed. Everything was built as asked."),
        "prompt as description": Answer("echo", {"scenario.yaml": f"{empty}# {instance.prompt!r}\n"}, instance.prompt),
    }
    for template in names():
        answers[f"template {template}"] = Answer(
            template, {**instance.case.files, "scenario.yaml": load(template).text}
        )
    for operator, answer in answers.items():
        short = operator.split()[0]
        yield Trial(case_id, "", "null", short, operator, False, instance, answer)


def _scene(text: str, gold: Answer, seed: int) -> Scene | None:
    """The world of a scenario; None if it cannot be built."""
    with tempfile.TemporaryDirectory() as folder:
        write_files(Path(folder), {}, gold.blobs)
        document = load_text(text, path=f"{folder}/scenario.yaml", limits=replace(LIMITS, root=folder))
        if document.fatal:
            return None
        reading = read(document, limits=document.limits)
        bad = [item for item in reading.diagnostics if item.severity == "error" or item.code == "unknown-key"]
        if reading.scenario is None or bad:
            return None
        try:
            return open_scene(reading.scenario, seed)
        except IrsimError:
            return None


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
            "null": proof.by_case[case, "null"],
            "wrong": bad[case],
        }
        for case in sorted({case for case, _ in proof.by_case})
    ]
