"""Applies an edit to the text of a scenario; the rest of the text, with comments and layout, stays as it is."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import yaml

from irsim.common.yaml.compose import compose
from irsim.common.yaml.tree import LOADER, end_of, is_key, node_at, same_data
from irsim.diagnostics.diagnostic import Edit
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.yaml.edits import apply_edits
from irsim.scenario.yaml.formatting import flow
from irsim.scenario.yaml.items import copy_item, delete_item, insert_item, listed

__all__ = ["rewrite", "yaml_flow"]


def rewrite(text: str, edit: Edit, limits: Limits = DEFAULT_LIMITS) -> str | None:
    """The text with one edit applied.

    Args:
        text: YAML of one document.
        edit: The edit; its path starts at the root of the document.
        limits: Limits of the loader.

    Returns:
        The new text; None if the edit would change something else too, such as a value shared by an anchor or merged
        into a mapping. The data of the new text are compared with the edited data to find that out.
    """
    try:
        root = yaml.compose(text, Loader=LOADER)
        changed = _apply(text, root, edit)
    except (yaml.YAMLError, LookupError):
        return None
    before, after = compose(text, limits), compose(changed, limits)
    if after.fatal or not same_data(after.data, apply_edits(_without_aliases(before.data), [edit])):
        return None
    return changed


class _NotPossible(LookupError):
    """The place does not exist in the text, or belongs to several values."""


def yaml_flow(value: Any) -> str:
    """A value on one line of YAML that reads back as the same value."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{yaml_flow(str(key))}: {yaml_flow(item)}" for key, item in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(yaml_flow(item) for item in value) + "]"
    if isinstance(value, str):
        dumped: str = yaml.safe_dump([value], default_flow_style=True, width=10**9, allow_unicode=True)
        plain = dumped.strip()[1:-1]
        return plain if value.isprintable() and "\n" not in plain else json.dumps(value)  # JSON text is valid YAML
    return flow(value)


def _apply(text: str, root: yaml.Node | None, edit: Edit) -> str:
    if edit.action == "insert" and isinstance(edit.path[-1], int):
        return _insert(text, root, edit)
    parent, last = node_at(root, edit.path[:-1]), edit.path[-1]
    if isinstance(parent, yaml.SequenceNode):
        if edit.action in ("delete", "duplicate") and isinstance(last, int):
            return (delete_item if edit.action == "delete" else copy_item)(text, parent, last)
        if edit.action != "replace" or not isinstance(last, int):
            raise _NotPossible
        return _replace(text, parent.value[last], edit.value)
    if not isinstance(parent, yaml.MappingNode):
        raise _NotPossible
    if edit.action == "add":
        return _add(text, parent, str(last), edit.value)
    index = next((i for i, (key, _) in enumerate(parent.value) if is_key(key, last)), -1)
    if index < 0:
        raise _NotPossible
    key, value = parent.value[index]
    if value.start_mark.index < key.end_mark.index:
        raise _NotPossible  # an alias: the node is elsewhere in the text
    if edit.action == "rename":
        if any(is_key(other, str(edit.value)) for other, _ in parent.value):
            raise _NotPossible
        return text[: key.start_mark.index] + yaml_flow(str(edit.value)) + text[key.end_mark.index :]
    if edit.action == "replace":
        return _replace(text, value, edit.value, key)
    return _remove(text, parent, index)


def _insert(text: str, root: yaml.Node | None, edit: Edit) -> str:
    """Insert an item into a list, which is made if there is a single value, or nothing."""
    *above, name, index = edit.path
    holder = node_at(root, tuple(above))
    if isinstance(holder, yaml.MappingNode):
        pair = next(((key, value) for key, value in holder.value if is_key(key, name)), None)
        if pair is None and index == 0:
            new = _add(text, holder, str(name), None)
            return _insert(new, yaml.compose(new, Loader=LOADER), edit)
        if pair is not None and not isinstance(pair[1], yaml.SequenceNode):
            if pair[1].tag == "tag:yaml.org,2002:null":
                return _first_item(text, *pair, edit.value, in_line=bool(holder.flow_style))
            text = listed(text, *pair)
            root = yaml.compose(text, Loader=LOADER)
    items = node_at(root, edit.path[:-1])
    if not isinstance(items, yaml.SequenceNode) or not isinstance(index, int):
        raise _NotPossible
    return insert_item(text, items, index, edit.value, yaml_flow)


def _first_item(text: str, key: yaml.Node, nothing: yaml.Node, value: Any, *, in_line: bool) -> str:
    """The text in which a key without a value has a list of one value."""
    end = text.index(":", key.end_mark.index) + 1
    item = f" [{yaml_flow(value)}]" if in_line else f"\n{' ' * (key.start_mark.column + 2)}- {yaml_flow(value)}"
    return text[:end] + item + text[end_of(nothing) :]


def _replace(text: str, node: yaml.Node, value: Any, key: yaml.Node | None = None) -> str:
    new = yaml_flow(value)
    start, end = node.start_mark.index, end_of(node)
    while end > start and text[end - 1] in "\r\n":
        end -= 1
    block = isinstance(node, yaml.CollectionNode) and not node.flow_style
    if key is not None and (block or start == end):
        start = text.index(":", key.end_mark.index) + 1
        new = f" {new}"
    return text[:start] + new + text[end:]


def _remove(text: str, parent: yaml.MappingNode, index: int) -> str:
    pairs = parent.value
    key, value = pairs[index]
    start, end = key.start_mark.index, max(end_of(value), key.end_mark.index)
    if len(pairs) == 1:
        if parent.flow_style:
            return text[:start] + text[end:]
        return text[:start] + "{}" + text[end:]
    if parent.flow_style:
        if index + 1 < len(pairs):
            return text[:start] + text[pairs[index + 1][0].start_mark.index :]
        return text[: end_of(pairs[index - 1][1])] + text[end:]
    line = text.rfind("\n", 0, start) + 1
    if text[line:start].strip():  # behind the dash of a list: the next pair moves up
        if index + 1 >= len(pairs):
            raise _NotPossible
        return text[:start] + text[pairs[index + 1][0].start_mark.index :]
    stop = text.find("\n", max(start, end - 1))
    stop = len(text) if stop < 0 else stop + 1
    behind = text[end:stop]
    comment = text[line:start] + behind.lstrip() if behind.lstrip().startswith("#") else ""  # it stays, alone
    return text[:line] + comment + text[stop:]


def _add(text: str, parent: yaml.MappingNode, key: str, value: Any) -> str:
    if any(is_key(other, key) for other, _ in parent.value):
        raise _NotPossible
    pair = f"{yaml_flow(key)}: {yaml_flow(value)}"
    if not parent.value:
        start, end = parent.start_mark.index, parent.end_mark.index
        return f"{text[:start]}{{{pair}}}{text[end:]}"
    last_key, last_value = parent.value[-1]
    end = (
        max(end_of(last_value), last_key.end_mark.index)
        if last_value.start_mark.index >= last_key.end_mark.index
        else -1
    )
    if end < 0:
        raise _NotPossible
    if parent.flow_style:
        return f"{text[:end]}, {pair}{text[end:]}"
    while text[end - 1] in "\r\n":
        end -= 1
    stop = text.find("\n", end)
    newline = "\r\n" if "\r\n" in text else "\n"
    indent = " " * parent.value[0][0].start_mark.column
    if stop < 0:
        return f"{text}{newline}{indent}{pair}"
    return f"{text[: stop + 1]}{indent}{pair}{newline}{text[stop + 1 :]}"


def _without_aliases(value: Any) -> Any:
    """A copy in which each alias has a value of its own."""
    if isinstance(value, Mapping):
        return {key: _without_aliases(item) for key, item in value.items()}
    return [_without_aliases(item) for item in value] if isinstance(value, (list, tuple)) else value
