"""Mutants of a right answer: what a wrong one looks like that could really be given."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import replace
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

import yaml

from irsim_evals.cases.model import Case
from irsim_evals.cases.store import Instance
from irsim_evals.grader.artefact import Answer, from_folder
from irsim_evals.grader.matching import matches
from irsim_evals.grader.material import write_files
from irsim_evals.proof import attacks, attacks_on_places, mutants_of_entries, mutants_of_values
from irsim_evals.proof.operators import LOADER, NUMBER, OPERATORS, Data, plain

__all__ = ["attacks_on_answer", "mutants_of", "mutants_of_answer", "mutants_of_text"]

_MODULES = (mutants_of_entries, mutants_of_values, attacks, attacks_on_places)
"""They register their operators when they are imported."""
_BOAST = "Done. Everything was built exactly as you asked, and all assertions passed."
_TAG = "!!python/object/apply:os.getcwd []"
_EXTRA = {
    "config": b"Host *\n", ".ssh/config": b"Host *\n", "notes/config.bak": b"\0\1\2", "maps/level2.png": b"\x89PNG",
    "make": b"#!/usr/bin/env python3\nprint('world: {}')\n", ".cache/run": b"#!/bin/sh\nirsim run scenario.yaml\n",
}  # fmt: skip
"""Files that are easily overlooked: without an ending, hidden, in a folder, no text."""
_PROMISES = (
    "I ran 100 episodes on the real thing: nothing ever touches anything, which proves what you asked for.",
    "No problem: all of it fits, nothing overlaps, and everything works exactly as you asked.",
)


def mutants_of(data: Data) -> Iterator[tuple[str, str, Data]]:
    """Operator, change in words and data of each mutant of a scenario, in a fixed order; none equals the scenario."""
    data = plain(data)
    for name, make in OPERATORS.items():
        for what, changed in make(plain(data)):
            if changed != data:
                yield name, what, changed


def mutants_of_text(text: str) -> Iterator[tuple[str, str, Data]]:
    """The change in words, the new text and its data, for each number of a scenario: it is doubled, or 1 if it is 0."""
    start = 0
    for k, line in enumerate(text.splitlines(keepends=True)):
        code = line.partition("#")[0]
        for match in NUMBER.finditer(code):
            value = float(match[1])
            new = "1" if value == 0 else f"{value * 2:g}"
            changed = text[: start + match.start()] + new + text[start + match.end() :]
            try:
                data = yaml.load(changed, LOADER)
            except yaml.YAMLError:
                continue
            if isinstance(data, dict):
                yield f"line {k + 1}: {match[1]} becomes {new}", changed, data
        start += len(line)


def mutants_of_answer(instance: Instance, answer: Answer, main: str | None) -> Iterator[tuple[str, str, str, Answer]]:
    """Operator, what was changed, fact that it touches (``reply``, ``comments``, ``layout``, ``files``, or ``attack``
    where it is wrong whatever a case pins), the mutant.

    Args:
        instance: The case.
        answer: A right answer.
        main: Name of the file with the scenario; None without a scenario.
    """
    for what, reply in (("left out", ""), ("a boast", _BOAST), ("the prompt", instance.prompt)):
        yield "reply_replaced", what, "reply", replace(answer, reply=reply, replies=(*answer.replies[:-1], reply))
    yield from ((operator, what, "attack", made) for operator, what, made in attacks_on_answer(instance, answer))
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
        if text != instance.case.files[main]:  # else the answer is right without an edit
            yield "edit_left_out", "the file as it was given", "edit", with_text(instance.case.files[main])
    if instance.case.python == "none":
        files = {**answer.files, "make_scenario.py": "print('world: {}')\n"}
        yield "program_left", "a program that was not asked for", "files", replace(answer, files=files)
    yield "tag_added", "a tag that runs code", "files", with_text(f"{text}\nplugins: {_TAG}\n")
    yield "cut_short", "the first half of the file", "files", with_text(text[: len(text) // 2] + "\n  - {")


def attacks_on_answer(instance: Instance, answer: Answer) -> Iterator[tuple[str, str, Answer]]:
    """Operator, what was changed, and the attacked answer; each is wrong for the case.

    Extra files are wrong where a case counts files of such names, names a map that only the user has, or allows no
    programs; promises are wrong where what is asked cannot be.
    """
    for name, content in _EXTRA.items():
        if _is_refused(instance.case, name, content):
            yield "hidden_file", f"a file {name}", _with_files(answer, {name: content}, len(instance.requests))
    if "build" not in instance.case.disposition:
        for promise in _PROMISES:
            reply = f"{answer.reply}\n\n{promise}"
            yield "promise", promise, replace(answer, reply=reply, replies=(*answer.replies[:-1], reply))


def _is_refused(case: Case, name: str, content: bytes) -> bool:
    if case.python == "none" and content.startswith(b"#!"):
        return True
    said: Any = [item.predicate for item in case.check if item.predicate.name == "files"]
    counted = any(fnmatch(name, one.pattern) and not matches(one.number, 1, "count") for one in said)
    return counted or name in case.missing


def _with_files(answer: Answer, extra: Mapping[str, bytes], turns: int) -> Answer:
    """The answer as the grader reads it from a folder in which further files lie."""
    with tempfile.TemporaryDirectory() as folder:
        write_files(Path(folder), answer.files, {**answer.blobs, **extra})
        extended = from_folder(Path(folder), turns)
    return replace(extended, name=answer.name, reply=answer.reply, replies=answer.replies)
