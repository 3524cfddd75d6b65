"""Where cases and their golds lie, and how they are read."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

import yaml

from irsim_evals.cases.drawing import draw
from irsim_evals.cases.instance import Instance, instance_of, substitute
from irsim_evals.grader.artefact import BINARY, Answer
from irsim_evals.grader.material import write_files

__all__ = ["all_case_ids", "case_ids", "case_of", "folder", "given_pictures", "golds_of", "raw_case", "write_given"]


def folder(kind: str) -> Path:
    """The folder ``cases`` or ``golds``: beside this package in a checkout, else in the installed data."""
    here = Path(__file__).resolve().parents[2] / kind
    return here if here.is_dir() else Path(__file__).resolve().parents[1] / "data" / kind


def case_ids() -> list[str]:
    """Ids of the cases that count: commands are about these unless others are named."""
    return sorted(path.stem for path in folder("cases").glob("*.yaml"))


def all_case_ids() -> list[str]:
    """Ids of all cases, including the tasks of the skills, which lie in folders of their own."""
    return sorted(_case_files())


@functools.cache
def _case_files() -> dict[str, Path]:
    """Id → file of each case."""
    return {path.stem: path for path in sorted(folder("cases").rglob("*.yaml"))}


@functools.cache
def raw_case(case_id: str) -> Any:
    """Content of a case file.

    Raises:
        KeyError: There is no such case.
    """
    return yaml.safe_load(_case_files()[case_id].read_text(encoding="utf-8"))


def case_of(case_id: str, seed: int | None = None) -> Instance:
    """An instance of a case; as published without a seed."""
    return instance_of(raw_case(case_id), seed)


def golds_of(instance: Instance) -> list[Answer]:
    """The golds of a case: answers that are known to be right."""
    root = folder("golds") / instance.case.id
    return [_gold(path, instance) for path in sorted(root.iterdir()) if path.is_dir()] if root.is_dir() else []


def given_pictures(instance: Instance) -> dict[str, bytes]:
    """The pictures that the folder of a case starts with: name → content of the file."""
    return {name: draw(drawing) for name, drawing in instance.case.drawings.items()}


def write_given(folder: Path, instance: Instance) -> None:
    """Write the files and pictures that the folder of a case starts with."""
    write_files(folder, instance.case.files, given_pictures(instance))


def _gold(path: Path, instance: Instance) -> Answer:
    texts, blobs = {}, given_pictures(instance)
    for file in sorted(path.rglob("*")):
        name = file.relative_to(path).as_posix()
        if file.suffix.lower() in BINARY:
            blobs[name] = file.read_bytes()
        elif file.is_file():
            texts[name] = substitute(file.read_text(encoding="utf-8") + "\0", instance.values).rstrip("\0")
    replies = tuple(texts.pop(name) for name in sorted(texts) if name.startswith("reply-"))
    reply = texts.pop("reply.md", "")
    return Answer(path.name, {**instance.case.files, **texts}, reply, (*replies, reply), blobs)
