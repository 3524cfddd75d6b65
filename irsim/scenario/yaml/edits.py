"""Applies edits to the data of a scenario."""

from __future__ import annotations

import copy
from collections.abc import Iterable
from typing import Any

from irsim.diagnostics.diagnostic import Edit, Path

__all__ = ["apply_edits", "removal_edit"]

_OF_LISTS = ("insert", "delete", "duplicate")
"""Actions that move the later items of a list."""


def apply_edits(data: Any, edits: Iterable[Edit]) -> Any:
    """A copy of ``data`` with the edits applied; an edit whose path no longer exists is skipped."""
    result = copy.deepcopy(data)
    for edit in edits:
        if not edit.path:
            result = edit.value if edit.action == "replace" else result
            continue
        parent = _parent(result, edit.path)
        if edit.action in _OF_LISTS:
            _edit_items(result, parent, edit)
        elif isinstance(parent, dict):
            _edit_mapping(parent, edit)
        elif isinstance(parent, list):
            _edit_list(parent, edit)
    return result


def removal_edit(path: Path) -> Edit:
    """The edit that removes the value at ``path`` without shifting its neighbours.

    For an element of a list it removes the whole key, but an entry of ``robot`` or ``obstacle`` it replaces by an empty
    one.
    """
    if len(path) == 2 and path[0] in ("robot", "obstacle"):
        return Edit("replace", path, {}) if isinstance(path[1], int) else Edit("remove", path)
    while path and not isinstance(path[-1], str):
        path = path[:-1]
    return Edit("remove", path)


def _parent(data: Any, path: Path) -> Any:
    for part in path[:-1]:
        try:
            data = data[part] if not isinstance(data, dict) else data[_key(data, part)]
        except (KeyError, IndexError, TypeError):
            return None
    return data


def _key(mapping: dict[Any, Any], part: str | int) -> Any:
    """Paths hold every key as text; the document may have numbers or booleans as keys."""
    return part if part in mapping else next((key for key in mapping if str(key) == part), part)


def _edit_items(data: Any, parent: Any, edit: Edit) -> None:
    index, holder = edit.path[-1], _parent(data, edit.path[:-1])
    if not isinstance(index, int) or index < 0:
        return
    if not isinstance(parent, list) and edit.action == "insert" and isinstance(holder, dict):
        parent = [] if parent is None else [parent]
        holder[_key(holder, edit.path[-2])] = parent
    if not isinstance(parent, list) or index > len(parent) - (edit.action != "insert"):
        return
    if edit.action == "delete":
        del parent[index]
    elif edit.action == "insert":
        parent.insert(index, edit.value)
    else:
        parent.insert(index + 1, copy.deepcopy(parent[index]))


def _edit_mapping(parent: dict[Any, Any], edit: Edit) -> None:
    key = _key(parent, edit.path[-1])
    if edit.action == "remove":
        parent.pop(key, None)
    elif edit.action == "rename":
        if key in parent and edit.value not in parent:
            parent[edit.value] = parent.pop(key)
        else:
            parent.pop(key, None)
    else:
        parent[key] = edit.value


def _edit_list(parent: list[Any], edit: Edit) -> None:
    index = edit.path[-1]
    if isinstance(index, int) and 0 <= index < len(parent):
        parent[index] = None if edit.action == "remove" else edit.value
