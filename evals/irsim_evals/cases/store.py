"""Where cases and their golds lie, and how they are read."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from irsim_evals.cases.instance import Instance, instance_of, substitute

__all__ = ["Answer", "case_ids", "case_of", "folder", "golds_of", "raw_case"]


@dataclass(frozen=True)
class Answer:
    """What somebody made of a case.

    Attributes:
        name: What it is called.
        files: Path in the folder → text.
        reply: Last message.
        replies: Message after each turn.
    """

    name: str
    files: Mapping[str, str] = field(default_factory=dict)
    reply: str = ""
    replies: tuple[str, ...] = ()


def folder(kind: str) -> Path:
    """The folder ``cases`` or ``golds``: beside this package in a checkout, else in the installed data."""
    here = Path(__file__).resolve().parents[2] / kind
    return here if here.is_dir() else Path(__file__).resolve().parents[1] / "data" / kind


def case_ids() -> list[str]:
    """Ids of all cases, sorted."""
    return sorted(path.stem for path in folder("cases").glob("*.yaml"))


@functools.cache
def raw_case(case_id: str) -> Any:
    """Content of a case file.

    Raises:
        KeyError: There is no such case.
    """
    path = folder("cases") / f"{case_id}.yaml"
    if not path.is_file():
        raise KeyError(case_id)
    return yaml.safe_load(path.read_text(encoding="utf-8"))


def case_of(case_id: str, seed: int | None = None) -> Instance:
    """An instance of a case; as published without a seed."""
    return instance_of(raw_case(case_id), seed)


def golds_of(instance: Instance) -> list[Answer]:
    """The golds of a case: answers that are known to be right."""
    root = folder("golds") / instance.case.id
    return [_gold(path, instance) for path in sorted(root.iterdir()) if path.is_dir()] if root.is_dir() else []


def _gold(path: Path, instance: Instance) -> Answer:
    texts = {
        str(file.relative_to(path)): substitute(file.read_text(encoding="utf-8") + "\0", instance.values).rstrip("\0")
        for file in sorted(path.rglob("*"))
        if file.is_file()
    }
    replies = tuple(texts.pop(name) for name in sorted(texts) if name.startswith("reply-"))
    reply = texts.pop("reply.md", "")
    return Answer(path.name, {**instance.case.files, **texts}, reply, (*replies, reply))
