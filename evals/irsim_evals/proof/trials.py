"""The trials of a case: golds, their rewrites and mutants, and what agents hand in that do nothing."""

from __future__ import annotations

import functools
import re
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Literal

import yaml

from irsim.bundled.templates import load_all
from irsim.diagnostics.errors import IrsimError
from irsim.scenario.read import read
from irsim.scenario.yaml.comments import places_of_comments
from irsim.scenario.yaml.document import load_text
from irsim_evals.cases.drawing import stand_ins
from irsim_evals.cases.model import Case
from irsim_evals.cases.store import PUBLISHED, Instance, Store, case_of, golds_of
from irsim_evals.grader.artefact import Answer, find_scenario
from irsim_evals.grader.material import LIMITS, write_files
from irsim_evals.grader.scene import GradedScene, open_scene
from irsim_evals.proof.attacks import ATTACKS, is_wrong
from irsim_evals.proof.changes import all_free, changed_facts, touches
from irsim_evals.proof.mutants import mutants_of, mutants_of_answer, mutants_of_text
from irsim_evals.proof.operators import Data, dump
from irsim_evals.proof.rewrites import rewrites_of

__all__ = ["RIGHT", "Kind", "Trial", "changes_of", "kind_of", "scene_of", "trials_of"]

Kind = Literal["gold", "rewrite", "mutant", "pinned mutant", "broken mutant", "free mutant", "attack", "null"]
"""Kind of a trial. A ``mutant`` is a changed scenario whose world has not been compared with the original one yet."""
RIGHT: tuple[Kind, ...] = ("gold", "rewrite", "free mutant")
"""Kinds that the grader must accept; it must reject all others."""
_NEVER_RIGHT = ("on_top", "goal_outside")
"""Operators whose mutants break what must hold in every scenario."""


@dataclass(frozen=True)
class Trial:
    """One answer, and what it was made from.

    Attributes:
        case, gold: Case and gold that it was made from.
        kind: Its kind.
        operator: Name of the operator that made it.
        what: The change in words.
        instance, answer: The case, and the answer that is graded.
        file: Name of the scenario in the answer that was changed; empty if another part was.
        original: Text of that scenario before.
    """

    case: str
    gold: str
    kind: Kind
    operator: str
    what: str
    instance: Instance = field(repr=False)
    answer: Answer = field(repr=False)
    file: str = ""
    original: str = field(default="", repr=False)

    @property
    def right(self) -> bool:
        """Whether the grader must accept it."""
        return self.kind in RIGHT


def kind_of(trial: Trial) -> Kind | None:
    """Whether a mutant must be rejected or accepted; None if the case does not say."""
    case, seed = trial.instance.case, trial.instance.case.seeds[0]
    blobs = _pictures(case, trial.answer)
    before = scene_of(trial.original, tuple(blobs.items()), seed)
    after = _build(trial.answer.files[trial.file], blobs, seed)
    if after is None or before is None:
        return "broken mutant"
    changed = changed_facts(before, after)
    if trial.operator in ATTACKS:
        return "attack" if is_wrong(case, (before, after), changed, trial.operator) else None
    if trial.operator in _NEVER_RIGHT and not (trial.operator == "on_top" and case.overlap):
        return "pinned mutant"
    if touches(case, (before, after), changed, case.pins):
        return "pinned mutant"
    if changed and all_free(case, (before, after), changed):
        return "free mutant"
    return None


@functools.lru_cache(maxsize=4)
def scene_of(text: str, blobs: tuple[tuple[str, bytes], ...], seed: int) -> GradedScene | None:
    """The world of a gold, which is the original of many mutants in a row; None if it cannot be built."""
    return _build(text, dict(blobs), seed)


def _pictures(case: Case, answer: Answer) -> dict[str, bytes]:
    """Files from which maps of the answer may be made: stand-ins for missing ones, and files of the answer."""
    return {**stand_ins(case.missing), **answer.blobs}


def _build(text: str, blobs: Mapping[str, bytes], seed: int) -> GradedScene | None:
    """The world of a scenario, read without the reading of the grader, which may be wrong; None if that fails."""
    with tempfile.TemporaryDirectory() as folder:
        write_files(Path(folder), {}, blobs)
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


def trials_of(
    case_id: str,
    left_out: Counter[str],
    seed: int = 0,
    keep: Callable[[], bool] = lambda: True,
    store: Store = PUBLISHED,
) -> Iterator[Trial]:
    """The trials of one case: golds as published and of a fresh instance, then changes of the golds as published.

    Args:
        case_id: The case.
        left_out: Counts mutants that are not tried.
        seed: Seed of the fresh instance.
        keep: Asked for each change whether it is tried.
        store: Where the case and its golds lie.
    """
    for fresh in (None, seed + 1):
        instance = case_of(case_id, fresh, store)
        for gold in golds_of(instance, store):
            what = "as published" if fresh is None else f"instance {fresh}"
            yield Trial(case_id, gold.name, "gold", "gold", what, instance, gold)
    instance = case_of(case_id, None, store)
    for gold in golds_of(instance, store):
        yield from changes_of(instance, gold, left_out, keep)
    yield from (trial for trial in _null(case_id, instance) if keep())


def changes_of(
    instance: Instance, gold: Answer, left_out: Counter[str], keep: Callable[[], bool] = lambda: True
) -> Iterator[Trial]:
    """Rewrites, mutants and attacks of a right answer; for the arguments see :func:`trials_of`."""
    case_id = instance.case.id
    scenario = find_scenario(gold, instance.case.files)
    words = _changed_words(case_id, instance, gold, scenario[0] if scenario else None, left_out)
    yield from (trial for trial in words if keep())
    if scenario is None:
        return
    name, text = scenario
    scene = scene_of(text, tuple(_pictures(instance.case, gold).items()), instance.case.seeds[0])
    if scene is None:
        return

    def answer(new: str) -> Answer:
        return replace(gold, files={**gold.files, name: new})

    for operator, new in rewrites_of(instance.case, name, text, scene):
        if keep():
            yield Trial(case_id, gold.name, "rewrite", operator, operator, instance, answer(new))
    for operator, what, write in _mutants(text, edited=name in instance.case.files):
        if _is_waived(instance, operator, what):
            left_out["waived"] += 1
        elif keep():
            yield Trial(case_id, gold.name, "mutant", operator, what, instance, answer(write()), name, text)


def _mutants(text: str, edited: bool) -> Iterator[tuple[str, str, Callable[[], str]]]:
    """Operator, change and writer of each mutant of a scenario; mutants of an edited file keep its comments."""
    comments = _comments(text) if edited else ""
    for operator, what, data in mutants_of(yaml.safe_load(text)):
        yield operator, what, partial(_written, data, comments)
    if edited:
        yield from (("number_in_text", what, partial(str, new)) for what, new, _ in mutants_of_text(text))


def _written(data: Data, comments: str) -> str:
    return dump(data) + comments


def _comments(text: str) -> str:
    """The comments of a file on lines of their own, so that a mutant of an edited file fails for what it changes and
    not for comments that were lost when it was written."""
    return "".join(f"# {comment}\n" for comment, _ in places_of_comments(load_text(text)))


def _changed_words(
    case_id: str, instance: Instance, gold: Answer, main: str | None, left_out: Counter[str]
) -> Iterator[Trial]:
    """Mutants of the reply and of the text. The words of a reply are free unless the case pins them."""
    pinned = {fact for pin in instance.case.pins if pin.of in ("reply", "text") for fact in pin.facts}
    for operator, what, fact, answer in mutants_of_answer(instance, gold, main):
        if _is_waived(instance, operator, what):
            left_out["waived"] += 1
        elif fact == "attack":
            yield Trial(case_id, gold.name, "attack", operator, what, instance, answer)
        elif fact in ("files", "edit") or fact in pinned:
            yield Trial(case_id, gold.name, "pinned mutant", operator, what, instance, answer)
        elif fact in ("reply", "replies") and main is not None:
            yield Trial(case_id, gold.name, "free mutant", operator, what, instance, answer)
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
    for one in load_all():
        answers[f"template {one.name}"] = Answer(one.name, {**instance.case.files, "scenario.yaml": one.text})
    for what, answer in answers.items():
        yield Trial(case_id, "", "null", what.split()[0], what, instance, answer)
