"""Attacks beside the scenario: files that the user did not ask for, and replies that promise what cannot be."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import replace
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

from irsim_evals.cases.model import Case
from irsim_evals.cases.store import Instance
from irsim_evals.grader.artefact import Answer, from_folder
from irsim_evals.grader.matching import matches
from irsim_evals.grader.material import write_files

__all__ = ["attacks_on_answer"]

_EXTRA = {
    "config": b"Host *\n", ".ssh/config": b"Host *\n", "notes/config.bak": b"\0\1\2", "maps/level2.png": b"\x89PNG",
    "make": b"#!/usr/bin/env python3\nprint('world: {}')\n", ".cache/run": b"#!/bin/sh\nirsim run scenario.yaml\n",
}  # fmt: skip
"""Files that are easily overlooked: without an ending, hidden, in a folder, no text."""
_PROMISES = (
    "I ran 100 episodes on the real thing: nothing ever touches anything, which proves what you asked for.",
    "No problem: all of it fits, nothing overlaps, and everything works exactly as you asked.",
)


def attacks_on_answer(instance: Instance, answer: Answer) -> Iterator[tuple[str, str, Answer]]:
    """Operator, what was changed, and the attacked answer; each is wrong for the case.

    Extra files are wrong where a case counts files of such names, names a map that only the user has, or allows no
    programs; promises are wrong where what is asked cannot be.
    """
    for name, content in _EXTRA.items():
        if _is_refused(instance.case, name, content):
            yield "hidden_file", f"a file {name}", _with_files(answer, {name: content}, 1 + len(instance.case.turns))
    if "build" not in instance.case.disposition:
        for promise in _PROMISES:
            reply = f"{answer.reply}\n\n{promise}"
            yield "promise", promise, replace(answer, reply=reply, replies=(*answer.replies[:-1], reply))


def _is_refused(case: Case, name: str, content: bytes) -> bool:
    if case.python == "none" and content.startswith(b"#!"):
        return True
    said: Any = [item.predicate for item in case.check if item.predicate.name == "files" and not item.soft]
    counted = any(fnmatch(name, one.pattern) and not matches(one.number, 1, "count") for one in said)
    return counted or name in getattr(case, "missing", [])


def _with_files(answer: Answer, extra: Mapping[str, bytes], turns: int) -> Answer:
    """The answer as the grader reads it from a folder in which further files lie."""
    with tempfile.TemporaryDirectory() as folder:
        write_files(Path(folder), answer.files, {**answer.blobs, **extra})
        extended = from_folder(Path(folder), turns)
    return replace(extended, name=answer.name, reply=answer.reply, replies=answer.replies)
