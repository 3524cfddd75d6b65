"""Adds an entry to a list in the text of a scenario; the rest of the text, with comments and layout, stays as it is."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

import yaml

from irsim.common.yaml.compose import compose
from irsim.common.yaml.tree import LOADER, end_of, node_at, same_data
from irsim.diagnostics.diagnostic import Path
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.yaml.rewrite import yaml_flow

__all__ = ["add_entry"]


def add_entry(
    text: str, key: str, entry: Sequence[str], *, prefix: Path = (), limits: Limits = DEFAULT_LIMITS
) -> str | None:
    """The text with one more entry at the end of a list such as ``obstacle``.

    A key that is missing or empty becomes a list, and so does a single entry. Lists in brackets stay on their lines.

    Args:
        text: YAML of one document.
        key: Name of the list.
        entry: Lines of the new entry, a mapping, without the dash before it.
        prefix: Keys that lead to the scenario in the text.
        limits: Limits of the loader.

    Returns:
        The new text; None if the text is written in a way in which nothing can be added safely: the data of the new
        text are compared with the data that are wanted.
    """
    newline = "\r\n" if "\r\n" in text else "\n"
    block = text if text.endswith(newline) or not text else text + newline
    try:
        mapping = node_at(yaml.compose(block, Loader=LOADER), prefix)
        changed = _added(block, mapping, key, entry, newline)
    except (yaml.YAMLError, LookupError):
        return None
    before, after = compose(text, limits), compose(changed or "", limits)
    new = compose("\n".join(entry), limits)
    if changed is None or before.fatal or after.fatal or new.fatal:
        return None
    for part in prefix:
        before.data, after.data = before.data[part], after.data[part]
    earlier = before.data.get(key)
    if not isinstance(earlier, (dict, list, type(None))):
        return None
    listed = [] if earlier is None else [earlier] if isinstance(earlier, dict) else list(earlier)
    return changed if same_data(after.data, {**before.data, key: [*listed, new.data]}) else None


def _added(text: str, mapping: yaml.Node, key: str, entry: Sequence[str], newline: str) -> str | None:
    if not isinstance(mapping, yaml.MappingNode) or mapping.flow_style or not mapping.value:
        return None
    margin = mapping.value[0][0].start_mark.column
    pairs = [pair for pair in mapping.value if isinstance(pair[0], yaml.ScalarNode) and pair[0].value == key]
    if not pairs:
        end = _line_end(text, mapping.end_mark.index - 1) if margin else mapping.end_mark.index
        return text[:end] + f"{' ' * margin}{key}:{newline}" + _dashed(entry, margin + 2, newline) + text[end:]
    ((name, value),) = pairs
    if value.start_mark.index < name.end_mark.index:
        return None  # an alias: the node is elsewhere in the text
    if isinstance(value, yaml.SequenceNode):
        return _in_brackets(text, value, entry) if value.flow_style else _in_block(text, value, margin, entry, newline)
    if isinstance(value, yaml.MappingNode) and value.value:
        return _beside_single(text, name, value, margin, entry, newline)
    text = text[: value.start_mark.index].rstrip(" ") + text[value.end_mark.index :]  # null, or an empty mapping
    end = _line_end(text, name.end_mark.index)
    return text[:end] + _dashed(entry, margin + 2, newline) + text[end:]


def _in_brackets(text: str, value: yaml.SequenceNode, entry: Sequence[str]) -> str:
    close = value.end_mark.index - 1
    behind = text[end_of(value.value[-1]) : close] if value.value else ","
    comma = "" if "," in "".join(line.partition("#")[0] for line in behind.splitlines()) else ", "
    return text[:close] + comma + yaml_flow(compose("\n".join(entry), DEFAULT_LIMITS).data) + text[close:]


def _in_block(text: str, value: yaml.SequenceNode, margin: int, entry: Sequence[str], newline: str) -> str:
    end = text.rfind("\n", 0, value.end_mark.index) + 1
    while True:  # blank lines and comments that are not indented belong to what follows
        start = text.rfind("\n", 0, end - 1) + 1
        line = text[start:end].strip()
        if line and (not line.startswith("#") or text.index(line, start) - start > margin):
            break
        end = start
    return text[:end] + _dashed(entry, value.start_mark.column, newline) + text[end:]


def _beside_single(
    text: str, name: yaml.Node, value: yaml.MappingNode, margin: int, entry: Sequence[str], newline: str
) -> str:
    start, end = value.start_mark.index, _line_end(text, end_of(value) - 1)
    lead = text.rfind("\n", 0, start) + 1
    if text[lead:start].strip():  # on the line of its key
        head = text[: name.end_mark.index] + ":" + newline + " " * (margin + 2) + "- " + text[start:end]
    else:
        shifted = textwrap.indent(text[start:end], "  ")
        head = text[:start] + "- " + shifted[2:]
    column = margin + 2 if text[lead:start].strip() else value.start_mark.column
    return head + _dashed(entry, column, newline) + text[end:]


def _line_end(text: str, index: int) -> int:
    """Index behind the line break that ends the line of an index."""
    stop = text.find("\n", max(index, 0))
    return len(text) if stop < 0 else stop + 1


def _dashed(entry: Sequence[str], column: int, newline: str) -> str:
    dashes = ["- ", *["  "] * (len(entry) - 1)]
    return "".join(f"{' ' * column}{dash}{line}{newline}" for dash, line in zip(dashes, entry, strict=True))
