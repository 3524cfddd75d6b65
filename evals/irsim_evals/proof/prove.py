"""The proof itself: golds, rewrites, mutants and null agents of every case, and one table of what came out."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, Literal

import yaml

from irsim.bundled.templates.store import load, names
from irsim.diagnostics.errors import IrsimError
from irsim.scenario.read import read
from irsim.scenario.yaml.document import load_text
from irsim_evals.cases.instance import Instance
from irsim_evals.cases.store import Answer, case_ids, case_of, golds_of
from irsim_evals.grader.artefact import find_scenario
from irsim_evals.grader.grade import LIMITS
from irsim_evals.grader.limited import grade_all
from irsim_evals.grader.outcome import Verdict
from irsim_evals.grader.scene import Scene, open_scene
from irsim_evals.proof.changes import changed_facts, touches
from irsim_evals.proof.mutants import mutants_of
from irsim_evals.proof.rewrites import rewrites_of

__all__ = ["Proof", "Trial", "prove", "trials_of"]

Kind = Literal["gold", "rewrite", "pinned mutant", "broken mutant", "free mutant", "null"]
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


@dataclass
class Proof:
    """What came out.

    Attributes:
        done: (kind, operator) → number of trials, and of those graded wrongly.
        wrong: Trials that were graded wrongly, with their verdicts.
        left_out: Mutants of facts that no case pins or leaves free: (operator) → number.
    """

    done: Counter[tuple[str, str]] = field(default_factory=Counter)
    wrong: list[tuple[Trial, Verdict]] = field(default_factory=list)
    left_out: Counter[str] = field(default_factory=Counter)

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


def prove(
    ids: list[str] | None = None,
    *,
    quick: bool = False,
    seed: int = 0,
    progress: Callable[[int, int], None] | None = None,
) -> Proof:
    """Try the grader on answers of which it is known whether they are right.

    Args:
        ids: Cases; default: all.
        quick: All golds, and a random tenth of the rest.
        seed: Seed of the choice, and of one fresh instance of each case.
        progress: Callback ``(done, total)``.
    """
    proof = Proof()
    trials = [trial for case_id in ids or case_ids() for trial in trials_of(case_id, proof.left_out, seed)]
    if quick:
        rng = random.Random(seed)
        trials = [trial for trial in trials if trial.kind == "gold" or rng.random() < _QUICK_SHARE]
    for number, verdict in enumerate(grade_all((trial.instance, trial.answer) for trial in trials)):
        trial = trials[number]
        proof.done[trial.kind, trial.operator] += 1
        if verdict.strict != trial.right:
            proof.wrong.append((trial, verdict))
        if progress is not None:
            progress(number + 1, len(trials))
    return proof


def trials_of(case_id: str, left_out: Counter[str], seed: int = 0) -> Iterator[Trial]:
    """All trials of one case: golds as published and of a fresh instance, then changes of the golds as published."""
    for fresh in (None, seed + 1):
        instance = case_of(case_id, fresh)
        for gold in golds_of(instance):
            what = "as published" if fresh is None else f"instance {fresh}"
            yield Trial(case_id, gold.name, "gold", "gold", what, True, instance, gold)
    instance = case_of(case_id)
    for gold in golds_of(instance):
        yield from _changed(case_id, instance, gold, left_out)
    yield from _null(case_id, instance)


def _changed(case_id: str, instance: Instance, gold: Answer, left_out: Counter[str]) -> Iterator[Trial]:
    found = find_scenario(gold, instance.case.files)
    if found is None:
        return
    name, text = found
    scene = _scene(text, instance.case.seeds[0])
    if scene is None:
        return

    def answer(new: str) -> Answer:
        return Answer(gold.name, {**gold.files, name: new}, gold.reply, gold.replies)

    if not instance.case.files:  # an edit is about the text, too
        for operator, new in rewrites_of(text, scene):
            yield Trial(case_id, gold.name, "rewrite", operator, operator, True, instance, answer(new))
    for mutant in mutants_of(yaml.safe_load(text)):
        new = yaml.safe_dump(mutant.data, sort_keys=False, allow_unicode=True)
        world = _scene(new, instance.case.seeds[0])
        if world is None:
            kind: Kind = "broken mutant"
            right = False
        else:
            changed = changed_facts(scene, world)
            if touches(instance.case, scene, changed, instance.case.pins):
                kind, right = "pinned mutant", False
            elif changed and changed == touches(instance.case, scene, changed, instance.case.free):
                kind, right = "free mutant", True
            else:
                left_out[mutant.operator] += 1
                continue
        yield Trial(case_id, gold.name, kind, mutant.operator, mutant.what, right, instance, answer(new))


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


def _scene(text: str, seed: int) -> Scene | None:
    """The world of a scenario; None if it cannot be built."""
    document = load_text(text, limits=LIMITS)
    if document.fatal:
        return None
    reading = read(document, limits=LIMITS)
    if reading.scenario is None or any(d.severity == "error" or d.code == "unknown-key" for d in reading.diagnostics):
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
