"""Edits of YAML text that keep every other character: new values, new items of lists, keys taken out."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import yaml

from irsim.bundled.templates.fill import format_value, replace_values
from irsim.diagnostics.diagnostic import Path

__all__ = ["add", "entries", "replace", "value_at"]

replace = replace_values


def value_at(data: Any, path: Path) -> Any:
    """The value at a path; None if there is none."""
    for part in path:
        try:
            data = data[part]
        except (KeyError, IndexError, TypeError):
            return None
    return data


def entries(data: Any, section: str) -> Iterator[tuple[Path, dict[str, Any]]]:
    """The entries of ``robot`` or ``obstacle`` with their paths, whether they are a list or a single one."""
    found = data.get(section) if isinstance(data, dict) else None
    if isinstance(found, dict):
        yield (section,), found
    for i, entry in enumerate(found if isinstance(found, list) else []):
        if isinstance(entry, dict):
            yield (section, i), entry


def add(text: str, path: Path, key: str, value: Any) -> str:
    """Add an item to the list under a key of a mapping; the list is made if there is none.

    Args:
        text: The file.
        path: Where the mapping is.
        key: Its key.
        value: The item.

    Raises:
        KeyError: There is no mapping at the path, or the key holds something else.
    """
    node = _node(yaml.compose(text, Loader=yaml.SafeLoader), path)
    if not isinstance(node, yaml.MappingNode):
        raise KeyError(path)
    held = next((child for name, child in node.value if name.value == key), None)
    if held is None:
        return _insert(text, node, f"{key}: {format_value([value])}")
    if not isinstance(held, yaml.SequenceNode):
        raise KeyError(key)
    return _insert(text, held, format_value(value) if held.flow_style else f"- {format_value(value)}")


def _insert(text: str, node: yaml.CollectionNode, new: str) -> str:
    """Insert something behind the last item of a mapping or a list."""
    last = node.value[-1][1] if isinstance(node, yaml.MappingNode) else node.value[-1] if node.value else None
    if node.flow_style or last is None:
        at = node.end_mark.index - 1
        before = text[:at].rstrip()
        return before + (", " if last is not None else "") + new + text[at:]
    at = len(text[: last.end_mark.index].rstrip())
    line_end = text.find("\n", at)
    at = len(text) if line_end < 0 else line_end
    return text[:at] + "\n" + " " * node.start_mark.column + new + text[at:]


def _node(node: yaml.Node | None, path: Path) -> yaml.Node | None:
    for part in path:
        if isinstance(node, yaml.MappingNode):
            node = {key.value: child for key, child in node.value}.get(str(part))
        elif isinstance(node, yaml.SequenceNode) and isinstance(part, int) and part < len(node.value):
            node = node.value[part]
        else:
            raise KeyError(part)
    return node
