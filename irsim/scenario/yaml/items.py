"""Items of lists in a text of YAML: one more, one less, a copy; comments and layout of all others stay."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any

import yaml

from irsim.common.yaml.tree import LOADER, end_of

__all__ = ["copy_item", "delete_item", "insert_item", "listed"]

_COMMA = re.compile(r"(?:\s|#[^\n]*\n)*,[ \t]*")
Flow = Callable[[Any], str]


def insert_item(text: str, items: yaml.SequenceNode, index: int, value: Any, flow: Flow) -> str:
    """The text with a value before an item, or behind the last one; in blocks as its neighbours are written.

    Args:
        text: The text.
        items: The list.
        index: Number of the item from 0; the length of the list appends.
        value: The value.
        flow: Writes a value on one line.

    Raises:
        IndexError: The list is shorter.
    """
    nodes = items.value
    if index > len(nodes):
        raise IndexError(index)
    if items.flow_style:
        return _insert_in_line(text, items, index, flow(value))
    column = _column(text, items)
    blocks = any(isinstance(node, yaml.MappingNode) and not node.flow_style for node in nodes)
    item = _block(value, column, flow) if blocks and isinstance(value, Mapping) and value else f"- {flow(value)}"
    return _put(text, items, index, item, column)


def copy_item(text: str, items: yaml.SequenceNode, index: int) -> str:
    """The text with a copy of an item behind it, comments on its lines included."""
    node = items.value[index]
    if items.flow_style:
        copy = _without_anchors(text, node.start_mark.index, node.end_mark.index)
        return _insert_in_line(text, items, index + 1, copy)
    dash = _dash(text, items, index)
    item = _without_anchors(text, dash, _line_end(text, max(dash, end_of(node)))).rstrip("\r\n")
    return _put(text, items, index + 1, item, _column(text, items))


def delete_item(text: str, items: yaml.SequenceNode, index: int) -> str:
    """The text without an item; lines of comments above it stay."""
    nodes = items.value
    node = nodes[index]
    if items.flow_style:
        start, end = node.start_mark.index, node.end_mark.index
        if index + 1 < len(nodes):
            behind = _COMMA.match(text, end)
            end = nodes[index + 1].start_mark.index if behind is None else behind.end()
        elif index:
            start = nodes[index - 1].end_mark.index
        else:
            start, end = items.start_mark.index + 1, items.end_mark.index - 1
        return text[:start] + _handed_on(text, start, end)
    dash = _dash(text, items, index)
    start, end = _line(text, dash), _line_end(text, max(dash, end_of(node)))
    if text[start:dash].strip():  # behind the dash of another list
        if len(nodes) == 1:
            return text[:dash] + "[]" + text[max(dash + 1, end_of(node)) :]
        return text[:dash] + _handed_on(text, dash, _dash(text, items, index + 1))
    if len(nodes) > 1:
        return text[:start] + _handed_on(text, start, end)
    colon = text.rfind(":", 0, _code_end(text, start))
    if colon < 0:
        return f"[]\n{text[:start]}{text[end:]}"
    return f"{text[: colon + 1]} []{text[colon + 1 : start]}{_handed_on(text, start, end)}"


def listed(text: str, key: yaml.Node, value: yaml.Node) -> str:
    """The text in which the value of a key is the only item of a list."""
    start, end = value.start_mark.index, end_of(value)
    if text[:start].rstrip(" ").endswith(":") and "\n" not in text[start:end]:
        return f"{text[:start].rstrip(' ')}\n{' ' * (key.start_mark.column + 2)}- {text[start:end]}{text[end:]}"
    begin = _line(text, start)
    if text[begin:start].strip():
        raise LookupError("the value begins on the line of its key and goes on below")
    lines = text[begin:end].split("\n")
    column = start - begin
    moved = [f"{' ' * column}- {lines[0][column:]}", *(f"  {line}" if line.strip() else line for line in lines[1:])]
    return text[:begin] + "\n".join(moved) + text[end:]


def _insert_in_line(text: str, items: yaml.SequenceNode, index: int, item: str) -> str:
    nodes = items.value
    if not nodes:
        return f"{text[: items.start_mark.index + 1]}{item}{text[items.end_mark.index - 1 :]}"
    own_lines = len({node.start_mark.line for node in nodes}) == len(nodes) > 1
    gap = f"\n{' ' * nodes[-1].start_mark.column}" if own_lines else " "
    if index < len(nodes):
        start = nodes[index].start_mark.index
        return f"{text[:start]}{item},{gap}{text[start:]}"
    end = nodes[-1].end_mark.index
    return f"{text[:end]},{gap}{item}{text[end:]}"


def _put(text: str, items: yaml.SequenceNode, index: int, item: str, column: int) -> str:
    """Put the lines of an item, which begin with its dash, before the item of that number."""
    newline = "\r\n" if "\r\n" in text else "\n"
    if index == 0:
        dash = _dash(text, items, 0)
        return f"{text[:dash]}{item}{newline}{' ' * column}{text[dash:]}"
    before = items.value[index - 1]
    place = _line_end(text, max(_dash(text, items, index - 1), end_of(before)))
    gap = "" if text[:place].endswith("\n") else newline
    return f"{text[:place]}{gap}{' ' * column}{item}{newline if not gap else ''}{text[place:]}"


def _block(value: Mapping[Any, Any], column: int, flow: Flow) -> str:
    lines = [f"{flow(str(key))}: {flow(one)}" for key, one in value.items()]
    return "- " + f"\n{' ' * (column + 2)}".join(lines)


def _column(text: str, items: yaml.SequenceNode) -> int:
    """Column of the dashes of a block."""
    first = _dash(text, items, 0)
    return first - _line(text, first)


def _dash(text: str, items: yaml.SequenceNode, index: int) -> int:
    """Index of the dash of an item of a block."""
    first = items.start_mark.index
    if not text.startswith("-", first):
        raise LookupError("a list whose dashes are elsewhere")
    if index == 0:
        return first
    column = first - _line(text, first)
    before = items.value[index - 1]
    begin = _line_end(text, max(before.start_mark.index, end_of(before)) - 1)
    match = re.compile(rf"^ {{{column}}}-(?=\s|$)", re.MULTILINE).search(text, begin)
    if match is None:
        raise LookupError("an item without a dash of its own")
    return match.end() - 1


def _line(text: str, place: int) -> int:
    """Index of the beginning of the line of a place."""
    return text.rfind("\n", 0, place) + 1


def _line_end(text: str, place: int) -> int:
    """Index behind the end of the line of a place; behind a line that is over it is the place itself."""
    if place and text[place - 1] == "\n":
        return place
    end = text.find("\n", place)
    return len(text) if end < 0 else end + 1


def _code_end(text: str, place: int) -> int:
    """Index of the end of the last line with data before a place, without the comment behind it."""
    lines = text[:place].split("\n")
    end = place
    for line in reversed(lines[:-1]):
        end -= len(line) + 1
        if line.strip() and not line.lstrip().startswith("#"):
            return end + (line.find(" #") if " #" in line else len(line))
    return 0


def _without_anchors(text: str, start: int, end: int) -> str:
    """A part of a text without its anchors, for a copy: the part itself keeps them."""
    part = text[start:end]
    for token in reversed(_tokens(text, yaml.AnchorToken, start, end)):
        part = part[: token.start_mark.index - start] + part[token.end_mark.index - start :].lstrip(" ")
    return part


def _handed_on(text: str, start: int, end: int) -> str:
    """The text behind a part that is deleted, with the values to which only the part gives names."""
    behind = text[end:]
    for anchor in _tokens(text, yaml.AnchorToken, start, end):
        name = re.compile(rf"\*{re.escape(anchor.value)}(?![\w-])")
        used = any(one.value == anchor.value for one in _tokens(text, yaml.AliasToken, end, len(text)))
        value, place = _named(yaml.compose(text, Loader=LOADER), anchor.start_mark.index), name.search(behind)
        if used and value is not None and place is not None:
            named = text[anchor.start_mark.index : end_of(value)]
            behind = behind[: place.start()] + named + behind[place.end() :]
    return behind


def _tokens(text: str, kind: type[Any], start: int, end: int) -> list[Any]:
    tokens = yaml.scan(text, Loader=LOADER)
    return [one for one in tokens if isinstance(one, kind) and start <= one.start_mark.index < end]


def _named(node: yaml.Node | None, place: int) -> yaml.Node | None:
    """The node whose anchor stands at a place."""
    if node is None or node.start_mark.index == place:
        return node
    if isinstance(node, yaml.MappingNode):
        inner = [one for pair in node.value for one in pair]
    else:
        inner = node.value if isinstance(node, yaml.SequenceNode) else []
    return next((one for child in inner if (one := _named(child, place)) is not None), None)
