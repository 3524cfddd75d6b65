"""Mutants of what comes with a scenario: the reply, the text of an edited file, programs and tags."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

import yaml

from irsim_evals.cases.instance import Instance
from irsim_evals.cases.store import Answer

__all__ = ["mutants_of_answer"]

_BOAST = "Done. Everything was built exactly as you asked, and all assertions passed."
_TAG = "!!python/object/apply:os.getcwd []"


def mutants_of_answer(instance: Instance, answer: Answer, main: str | None) -> Iterator[tuple[str, str, str, Answer]]:
    """Operator, what was changed, fact that it touches (``reply``, ``comments``, ``layout``, ``files``), the mutant.

    Args:
        instance: The case.
        answer: A right answer.
        main: Name of the file with the scenario; None if there is none.
    """
    for what, reply in (("left out", ""), ("a boast", _BOAST), ("the prompt", instance.prompt)):
        yield "reply_replaced", what, "reply", replace(answer, reply=reply, replies=(*answer.replies[:-1], reply))
    earlier = answer.replies[:-1]
    if earlier:
        yield "reply_replaced", "earlier ones left out", "replies", replace(answer, replies=("", *answer.replies[1:]))
    if main is None:
        return
    text = answer.files[main]

    def with_text(new: str) -> Answer:
        return replace(answer, files={**answer.files, main: new})

    if main in instance.case.files:
        plain = re.sub(r"\s*#.*", "", text)
        if plain != text:
            yield "comments_dropped", "all comments", "comments", with_text(plain.lstrip("\n"))
        data = yaml.safe_load(text)
        yield "reformatted", "written by a program", "layout", with_text(yaml.safe_dump(data, sort_keys=False))
        yield "edit_left_out", "the file as it was given", "edit", with_text(instance.case.files[main])
    if instance.case.python == "none":
        files = {**answer.files, "make_scenario.py": "print('world: {}')\n"}
        yield "program_left", "a program that nobody asked for", "files", replace(answer, files=files)
    yield "tag_added", "a tag that runs code", "files", with_text(f"{text}\nplugins: {_TAG}\n")
    yield "cut_short", "the first half of the file", "files", with_text(text[: len(text) // 2] + "\n  - {")
