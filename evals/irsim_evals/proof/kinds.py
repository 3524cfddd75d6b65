"""What a mutant is: the facts in which its world differs from the original one are pinned by the case, or free."""

from __future__ import annotations

import functools
import tempfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from irsim.diagnostics.errors import IrsimError
from irsim.scenario.read import read
from irsim.scenario.yaml.document import load_text
from irsim_evals.grader.grade import LIMITS
from irsim_evals.grader.material import write_files
from irsim_evals.grader.scene import Scene, open_scene
from irsim_evals.proof.changes import changed_facts, touches
from irsim_evals.proof.trial import Kind, Trial

__all__ = ["kind_of", "scene_of"]

_NEVER_RIGHT = ("on_top", "goal_outside")
"""Operators whose mutants break what must hold in every scenario."""


def kind_of(trial: Trial) -> Kind | None:
    """Whether a mutant must be rejected or accepted; None if the case does not say."""
    case, seed = trial.instance.case, trial.instance.case.seeds[0]
    before = scene_of(trial.original, tuple(trial.answer.blobs.items()), seed)
    after = _build(trial.answer.files[trial.file], trial.answer.blobs, seed)
    if after is None or before is None:
        return "broken mutant"
    changed = changed_facts(before, after)
    if trial.operator in _NEVER_RIGHT and not (trial.operator == "on_top" and case.overlap):
        return "pinned mutant"
    if touches(case, (before, after), changed, case.pins):
        return "pinned mutant"
    if changed and changed == touches(case, (before, after), changed, case.free):
        return "free mutant"
    return None


@functools.lru_cache(maxsize=4)
def scene_of(text: str, blobs: tuple[tuple[str, bytes], ...], seed: int) -> Scene | None:
    """The world of a gold, which is the original of many mutants in a row; None if it cannot be built."""
    return _build(text, dict(blobs), seed)


def _build(text: str, blobs: Mapping[str, bytes], seed: int) -> Scene | None:
    """The world of a scenario; None if it cannot be built."""
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
