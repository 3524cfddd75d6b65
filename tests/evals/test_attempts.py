"""Attempts to fool the grader, each a file of ``attempts/``: an answer to a case, and whether it is right.

``<case>-<trick>.yaml`` has these keys::

    case: pub-15           # name of a case, or a case written out
    truth: wrong           # or right
    why: The robot drives through people that are passable.
    before: accepted       # or rejected: the first verdict, before the grader was mended
    fails: [solid]         # assertions that a wrong answer must fail; others may fail, too
    gold: people           # a gold that the answer starts from; without one it starts from the given files
    replace: {old: new}    # what differs in the texts of the gold; each occurs there
    files: {name: text}    # further files
    pictures: [name]       # pictures that it draws
    reply: Done.           # last message of the agent
    replies: [a, b]        # its messages after each turn, where the user writes several times
    slow: true             # grading takes more than a second
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import pytest
import yaml
from pydantic import BaseModel, ConfigDict

from irsim_evals.cases.drawing import stand_ins
from irsim_evals.cases.store import Instance, case_of, golds_of, instance_of
from irsim_evals.grader.artefact import Answer, from_folder
from irsim_evals.grader.grade import grade
from irsim_evals.grader.material import write_files
from tests.evals.conftest import failed, failures

FILES = sorted((Path(__file__).parent / "attempts").glob("*.yaml"))
MADE_UP = {"id": "made-up", "title": "x", "category": ["basic"], "level": 1, "prompt": "x"}


class Attempt(BaseModel):
    """One attempt; the docstring of this file says what the keys mean."""

    model_config = ConfigDict(extra="forbid")

    case: str | dict[str, Any]
    truth: Literal["right", "wrong"]
    why: str
    before: Literal["accepted", "rejected"]
    fails: list[str] = []
    gold: str = ""
    replace: dict[str, str] = {}
    files: dict[str, str] = {}
    pictures: list[str] = []
    reply: str | None = None
    replies: list[str] | None = None
    slow: bool = False

    def instance(self) -> Instance:
        return case_of(self.case) if isinstance(self.case, str) else instance_of(MADE_UP | self.case)

    def answer(self, instance: Instance) -> Answer:
        golds = {gold.name.rpartition("/")[2]: gold for gold in golds_of(instance)} if self.gold else {}
        start = golds.get(self.gold, Answer("attempt", dict(instance.case.files)))
        files = dict(start.files)
        assert not self.gold or self.gold in golds, f"the golds are {', '.join(golds)}"
        for old, new in self.replace.items():
            assert any(old in text for text in files.values()), f"{old!r} occurs nowhere"
            files = {name: text.replace(old, new) for name, text in files.items()}
        reply = start.reply if self.reply is None else self.reply
        replies = self.replies if self.replies is not None else [reply] if self.reply is not None else start.replies
        blobs = {**start.blobs, **stand_ins(self.pictures)}
        return Answer("attempt", {**files, **self.files}, reply, tuple(replies), blobs)


def attempts() -> list[Any]:
    kept = []
    for path in FILES:
        attempt = Attempt.model_validate(yaml.safe_load(path.read_text(encoding="utf-8")))
        kept.append(pytest.param(attempt, id=path.stem, marks=[pytest.mark.slow] if attempt.slow else []))
    return kept


@pytest.mark.parametrize("attempt", attempts())
def test_the_verdict_on_an_attempt_is_right(attempt: Attempt, tmp_path: Path) -> None:
    instance = attempt.instance()
    answer = attempt.answer(instance)
    write_files(tmp_path, answer.files, answer.blobs)
    read = from_folder(tmp_path)  # as the command reads it
    verdict = grade(instance, replace(answer, files=read.files, blobs=read.blobs, others=read.others))
    assert verdict.strict == (attempt.truth == "right"), failures(verdict)
    assert set(attempt.fails) <= set(failed(verdict))
    assert attempt.truth == "wrong" or not attempt.fails
