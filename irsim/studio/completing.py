"""Words that may stand at the cursor: keys, names and values of the language, with units, defaults and meanings."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from irsim.common.yaml.compose import compose
from irsim.diagnostics.diagnostic import Path
from irsim.lookup.answer import first_sentence
from irsim.lookup.language import language_schema
from irsim.lookup.schema_walk import Node, alternatives, component_name, key, mappings
from irsim.lookup.synonyms import EVERYDAY
from irsim.scenario.limits import DEFAULT_LIMITS

__all__ = ["complete"]

_MARK = "irsim0cursor"
_WORD = re.compile(r"[\w./-]+$")
_CLOSING = {"{": "}", "[": "]"}
_MOST = 80


def complete(text: str, line: int, column: int) -> dict[str, Any]:
    """The words that fit at a place in a text.

    Args:
        text: The text, which need not be valid.
        line: Line of the cursor, counted from 1.
        column: Column of the cursor, counted from 0.

    Returns:
        ``column`` where the begun word starts, and ``options``: ``label``, ``apply`` (the text to write), ``detail``
        (unit and default, or type), ``info`` (its meaning) and ``kind``.
    """
    lines = text.split("\n")
    if not 0 < line <= len(lines):
        return {"column": column, "options": []}
    row = lines[line - 1]
    begun_at = len(_WORD.sub("", row[:column]))
    begun = row[begun_at:column].lower()
    for is_key, parsed in _parsed(lines, line - 1, begun_at, column):
        place = _marked(parsed, ())
        if place is None:
            continue
        path, siblings = place
        options = _keys(path, siblings) if is_key else _values(path, siblings)
        fitting = sorted(filter(None, (_rank(begun, *one) for one in options)), key=lambda ranked: ranked[0])
        if fitting:
            return {"column": begun_at, "options": [option for _, option in fitting[:_MOST]]}
    return {"column": begun_at, "options": []}


def _parsed(lines: list[str], at: int, start: int, end: int) -> Iterator[tuple[bool, Any]]:
    """The data of the text with a mark at the cursor, as a key and as a value, whole or up to its line."""
    before, after = lines[at][:start], re.sub(r"^[\w./-]*", "", lines[at][end:])
    value_first = before.rstrip().endswith((":", "["))
    for is_key in (False, True) if value_first else (True, False):
        mark = f"{_MARK}: 0" if is_key else _MARK
        if is_key and after.lstrip().startswith(":"):
            mark = _MARK
        for rest, below in ((after, lines[at + 1 :]), (_closing(before), [])):
            made = compose("\n".join([*lines[:at], f"{before}{mark}{rest}", *below]), DEFAULT_LIMITS)
            if not made.fatal:
                yield is_key, made.data


def _closing(before: str) -> str:
    """The brackets that are open in a line."""
    open_ones = list[str]()
    for character in before:
        if character in _CLOSING:
            open_ones.append(_CLOSING[character])
        elif open_ones and character == open_ones[-1]:
            open_ones.pop()
    return "".join(reversed(open_ones))


def _marked(data: Any, path: Path) -> tuple[Path, list[dict[str, Any]]] | None:
    """Path of the mapping or value with the mark, and the mappings on the way to it."""
    if isinstance(data, dict):
        if _MARK in data:
            return path, [data]
        for name, item in data.items():
            if item == _MARK:
                return (*path, str(name)), [data]
            if (place := _marked(item, (*path, str(name)))) is not None:
                return place[0], [data, *place[1]]
    elif isinstance(data, list):
        for item in data:
            if item == _MARK:
                return path, []
            if (place := _marked(item, path)) is not None:
                return place
    return None


def _nodes(path: Path, siblings: list[dict[str, Any]]) -> list[Node]:
    """Nodes of the schema at a path; the name of a component on the way chooses among its alternatives."""
    root = language_schema()
    nodes = [root]
    for depth, word in enumerate(path):
        chosen = siblings[depth] if depth < len(siblings) else {}
        nodes = [one["properties"][word] for one in _chosen(root, nodes, chosen) if word in one["properties"]]
    return nodes


def _chosen(root: Node, nodes: list[Node], written: dict[str, Any]) -> list[Node]:
    options = [option for node in nodes for option in mappings(root, node)]
    return [option for option in options if component_name(option) == written.get("name", ...)] or options


def _keys(path: Path, siblings: list[dict[str, Any]]) -> Iterator[tuple[str, dict[str, Any]]]:
    root = language_schema()
    written = siblings[-1] if siblings else {}
    offered = set(written)
    for option in _chosen(root, _nodes(path, siblings), written):
        name = component_name(option)
        for word, node in option["properties"].items():
            if word in offered:
                continue
            offered.add(word)
            about = key(root, word, node)
            facts = [about.unit or about.type, *([] if about.default is None else [f"default {about.default}"])]
            text = {"label": word, "apply": f"{word}: ", "detail": ", ".join(filter(None, facts)), "info": about.text}
            above = [name] if name and "name" in written else []
            yield _topic(*path, *above, word), {**text, "kind": "property"}


def _values(path: Path, siblings: list[dict[str, Any]]) -> Iterator[tuple[str, dict[str, Any]]]:
    root, offered = language_schema(), set[str]()
    if path and path[-1] == "name":
        for option in [option for node in _nodes(path[:-1], siblings) for option in mappings(root, node)]:
            if (name := component_name(option)) and name not in offered:
                offered.add(name)
                yield _topic(*path[:-1], name), _component(name, name, option)
        return
    for node in _nodes(path, siblings):
        for option in mappings(root, node):
            name = component_name(option)
            if name and name not in offered:
                offered.add(name)
                yield _topic(*path, name), _component(name, f"{{name: {name}}}", option)
        for option in alternatives(root, node):
            values = [option["const"]] if "const" in option else list(option.get("enum", []))
            if option.get("type") == "boolean":
                values += [True, False]
            for value in values:
                label = str(value).lower() if isinstance(value, bool) else str(value)
                if label not in offered:
                    offered.add(label)
                    yield label, {"label": label, "apply": label, "detail": "", "info": "", "kind": "enum"}


def _component(name: str, apply: str, option: Node) -> dict[str, Any]:
    info = first_sentence(str(option.get("description", "")))
    return {"label": name, "apply": apply, "detail": "", "info": info, "kind": "class"}


def _topic(*words: str | int) -> str:
    """The topic of a place; obstacles have the ones of robots."""
    return ".".join(map(str, words)).replace("obstacle.", "robot.", 1)


def _rank(begun: str, topic: str, option: dict[str, Any]) -> tuple[int, dict[str, Any]] | None:
    """How well an option fits a begun word, the best 0; None if it does not."""
    label = option["label"].lower()
    if label.startswith(begun):
        return 0, option
    if begun in label:
        return 1, option
    words = EVERYDAY.get(topic, "")
    if len(begun) > 1 and any(word.strip().startswith(begun) for word in words.split(",")):
        return 2, option
    return None
