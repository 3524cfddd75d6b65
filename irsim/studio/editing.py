"""Edits by mouse or click, made in the text: only what is edited changes, and nothing else that means something."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import count
from typing import Any, get_args

from irsim.diagnostics.diagnostic import Action, Edit, Path
from irsim.scenario.limits import Limits
from irsim.scenario.model.lookup import at
from irsim.scenario.yaml.document import Document, load_text
from irsim.scenario.yaml.rewrite import rewrite

__all__ = ["NotEdited", "edit"]

_SHARED = "it is written once for several places (an anchor, an alias or a merge), and an edit would change all of them"

_ACTIONS: tuple[Action, ...] = get_args(Action)
_PLACE = ("x", "y")
"""Numbers that every place has."""
_ASIDE = (0.5, -0.5)
"""How far from an object its copy is put [m]."""


class NotEdited(ValueError):
    """An edit that cannot be made; the message says why."""


def edit(text: str, edits: Sequence[Mapping[str, Any]], limits: Limits) -> str:
    """The text after some edits, one after the other.

    Args:
        text: The text.
        edits: Each has an ``action``, a ``path`` into the scenario and perhaps a ``value``. Actions are the ones of
            :class:`irsim.diagnostics.Edit`; ``numbers``, which replaces the first numbers of a list and leaves its
            length; ``append``, which puts a value behind the entries of a role; and ``delete`` and ``duplicate``,
            which take an entry outside of a list, too.
        limits: Limits of the reader.

    Raises:
        NotEdited: One of them cannot be made; none is then.
    """
    for one in edits:
        document = load_text(text, limits=limits)
        for step in _steps(document, one["action"], tuple(one["path"]), one.get("value")):
            changed = rewrite(text, Edit(step.action, (*document.prefix, *step.path), step.value), limits)
            if changed is None:
                raise NotEdited(_SHARED)
            text = changed
    return text


def _steps(document: Document, action: str, path: Path, value: Any) -> list[Edit]:
    """The edits of the text that make one edit of the page."""
    written = at(document.data, path)
    single = not isinstance(path[-1], int)
    if action == "numbers":
        return _numbers(document, path, written, value)
    if action == "append":
        there = len(written) if isinstance(written, list) else 0 if written is None else 1
        return [Edit("insert", (*path, there), value)]
    if action == "delete" and single:
        return [Edit("remove", path)]
    if action == "duplicate":
        return _copied(document, path, written)
    if action not in _ACTIONS:
        raise NotEdited(f"there is no edit '{action}'")
    return [Edit(action, path, value)]


def _copied(document: Document, path: Path, written: Any) -> list[Edit]:
    """Edits that put a copy of an entry behind it, with a name of its own, beside it in the world."""
    single = not isinstance(path[-1], int)
    copy: Path = (*path, 1) if single else (*path[:-1], int(path[-1]) + 1)
    steps = [Edit("insert", copy, written) if single else Edit("duplicate", path)]
    entry = written if isinstance(written, Mapping) else {}
    if isinstance(name := entry.get("name"), str):
        others = {one for role in ("robot", "obstacle") for one in _names(at(document.data, (role,)))}
        stem = name.rstrip("0123456789").rstrip("_") or name
        steps.append(
            Edit("replace", (*copy, "name"), next(f"{stem}_{k}" for k in count(2) if f"{stem}_{k}" not in others))
        )
    state = entry.get("state")
    if isinstance(state, list) and len(state) >= len(_PLACE) and all(_is_number(value) for value in state):
        steps += [Edit("replace", (*copy, "state", k), round(state[k] + _ASIDE[k], 6)) for k in range(len(_PLACE))]
    return steps


def _names(entries: Any) -> list[Any]:
    listed = entries if isinstance(entries, list) else [entries]
    return [one.get("name") for one in listed if isinstance(one, Mapping)]


def _numbers(document: Document, path: Path, written: Any, numbers: Sequence[float]) -> list[Edit]:
    """Edits that replace the numbers of a list that differ; all of it if it is shorter, or not there."""
    if written is None:
        above = at(document.data, path[:-1])
        action: Action = "replace" if isinstance(above, Mapping) and path[-1] in above else "add"
        return [Edit(action, path, list(numbers))]
    if not isinstance(written, list) or not all(_is_number(item) for item in written):
        raise NotEdited("it is not written as a list of numbers")
    if len(written) < len(_PLACE):
        return [Edit("replace", path, list(numbers))]
    return [
        Edit("replace", (*path, k), value) for k, value in enumerate(numbers[: len(written)]) if written[k] != value
    ]


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)
