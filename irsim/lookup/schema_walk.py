"""Finds nodes in the JSON Schema of the language by the words of a path, and describes in words what they accept."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator
from typing import Any

from irsim.common.text import listed
from irsim.lookup.answer import Key
from irsim.options.units import MAX_TOLD

__all__ = [
    "COLOR",
    "Node",
    "alternatives",
    "component_name",
    "components",
    "definitions_of",
    "key",
    "mappings",
    "paths",
    "step",
    "unknown_key",
    "yaml_text",
]

Node = dict[str, Any]
"""A schema node with references and siblings merged in."""

_NUMBER_BOUNDS = {
    "minimum": "at least",
    "exclusiveMinimum": "more than",
    "maximum": "at most",
    "exclusiveMaximum": "less than",
}
COLOR = "A color is a name, `'#3366cc'`, a grey level as text (`'0.5'`), or `[r, g, b]` from 0 to 1."
MAX_NAMES = 24
"""Longer lists of allowed names are cut off."""
_TYPE_WORDS = {
    "number": "a number",
    "integer": "an integer",
    "boolean": "true or false",
    "string": "text",
    "object": "a mapping",
}


def alternatives(root: Node, node: Node) -> Iterator[Node]:
    """Resolve references and unions: return one node for each alternative that a node accepts."""
    while "$ref" in node:
        target: Node = root
        for part in node["$ref"].removeprefix("#/").split("/"):
            target = target[part.replace("~1", "/").replace("~0", "~")]
        node = {**target, **{name: value for name, value in node.items() if name != "$ref"}}
    for union in ("anyOf", "oneOf"):
        if union in node and "properties" not in node:  # beside properties it says which of them go together
            for option in node[union]:
                yield from alternatives(root, option)
            return
    if "allOf" in node:
        merged: Node = {name: value for name, value in node.items() if name != "allOf"}
        for option in node["allOf"]:
            for part in alternatives(root, option):
                merged = {**part, **merged}
        yield merged
        return
    yield node


def mappings(root: Node, node: Node) -> list[Node]:
    """Return the mappings that a node accepts, including those in lists."""
    options: list[Node] = []
    for option in alternatives(root, node):
        if "properties" in option:
            options.append(option)
        elif isinstance(option.get("items"), dict):
            options += mappings(root, option["items"])
    unique = {json.dumps(option, sort_keys=True): option for option in options}
    return list(unique.values())


def component_name(mapping: Node) -> str | None:
    """Return the name that selects this mapping among others, such as ``rvo``."""
    name = mapping["properties"].get("name", {})
    name = name["anyOf"][0] if "anyOf" in name else name
    names = [value for option in [name, *name.get("anyOf", [])] for value in _values(option)]
    return str(names[0]) if len(names) == 1 else None


def components(root: Node, node: Node) -> dict[str, Node]:
    """Return the mappings that are selected by their name."""
    return {name: option for option in mappings(root, node) if (name := component_name(option)) is not None}


def step(root: Node, nodes: list[Node], word: str) -> list[Node]:
    """Follow one word of a path, a key or the name of a component, and return the nodes that it leads to."""
    options = [option for node in nodes for option in mappings(root, node)]
    named = [option for option in options if component_name(option) == word]
    return named or [option["properties"][word] for option in options if word in option["properties"]]


def unknown_key(root: Node, path: str) -> tuple[str, str, list[str]] | None:
    """The first key of a path that the language lacks; None if there are all.

    Args:
        root: JSON Schema of the language.
        path: Such as ``robot[0].vel_max[1]``. Below a mapping of the user's own every key exists.

    Returns:
        The path to the mapping that lacks the key, the key, and the keys that the mapping may have.
    """
    nodes, place = [root], ""
    for word in re.sub(r"\[[^\]]*\]", "", path).split("."):
        options = [option for node in nodes for option in mappings(root, node)]
        kinds = {option.get("type", "object") for node in nodes for option in alternatives(root, node)}
        if not options and "object" in kinds:
            return None
        inner = [option["properties"][word] for option in options if word in option["properties"]]
        if not inner:
            return place, word, sorted({key for option in options for key in option["properties"]})
        nodes, place = inner, f"{place}.{word}".lstrip(".")
    return None


def paths(
    root: Node, prefix: tuple[str, ...] = (), node: Node | None = None, depth: int = 6
) -> Iterator[tuple[tuple[str, ...], Node]]:
    """Iterate over all paths of the language, including components, and the nodes that they lead to."""
    if depth == 0:
        return
    for option in mappings(root, root if node is None else node):
        name = component_name(option)
        here = (*prefix, name) if name else prefix
        if name:
            yield here, option
        for word, child in option["properties"].items():
            yield (*here, word), child
            yield from paths(root, (*here, word), child, depth - 1)


def definitions_of(root: Node, node: Any) -> dict[str, Node]:
    """Return all definitions that a node refers to, directly or through others, sorted by name."""
    definitions: dict[str, Node] = {}
    waiting = [node]
    while waiting:
        item = waiting.pop()
        if isinstance(item, list):
            waiting += item
        elif isinstance(item, dict):
            waiting += item.values()
            name = str(item.get("$ref", "")).removeprefix("#/$defs/")
            if name and name not in definitions:
                definitions[name] = root["$defs"][name]
                waiting.append(definitions[name])
    return dict(sorted(definitions.items()))


def key(root: Node, name: str, node: Node, required: bool = False) -> Key:
    """Describe a key in words."""
    options = list(alternatives(root, node))
    units = [unit for option in options if (unit := _unit(root, option))]
    default = node.get("default")
    allowed = [str(value) for option in options for value in _values(option)]
    ranges = [text for option in options if (text := _range(option))]
    texts = [str(option["description"]) for option in [node, *options] if option.get("description")]
    kind, per_object = _type(root, options)
    if len(allowed) > MAX_NAMES and name.endswith("color"):
        kind, allowed = "a color" + (" or cycle" if "cycle" in allowed else ""), []
    return Key(
        name=name,
        type=kind,
        unit=units[0] if units and units[0] != "1" else None,
        default=None if default is None or default == {} else yaml_text(default),
        required=required,
        allowed=listed(list(dict.fromkeys(allowed)), MAX_NAMES) or "; ".join(dict.fromkeys(ranges)) or None,
        per_object=per_object,
        text=" ".join(texts[0].split()) if texts else "",
    )


def yaml_text(value: Any) -> str:
    """Write a value as one line of YAML."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{name}: {yaml_text(item)}" for name, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(yaml_text, value)) + "]"
    if isinstance(value, bool) or value is None:
        return json.dumps(value)
    if isinstance(value, float):
        return f"{value:g}"
    plain = not isinstance(value, str) or re.fullmatch(r"[A-Za-z_][\w./-]*( [\w./-]+)*", value)
    return str(value) if plain else json.dumps(value, ensure_ascii=False)


def _type(root: Node, options: list[Node]) -> tuple[str, bool]:
    """Return the type that the options accept, in words, and whether a list gives one such value to each object."""
    words = []
    per_object = False
    plain = {_digest(option) for option in options}
    for option in options:
        kind = option.get("type")
        if kind == "array" and isinstance(option.get("items"), dict):
            items = list(alternatives(root, option["items"]))
            if "x-per" in option:
                words.append(f"a list with one per {option['x-per']}")
            elif {_digest(item) for item in items} & plain:
                per_object = True
            else:
                words.append(_list_type(root, option, items))
        elif "properties" in option:
            words.append("a mapping")
        elif kind == "null":
            continue
        elif _values(option):
            words.append("a name" if isinstance(_values(option)[0], str) else "a value")
        elif kind in _TYPE_WORDS:
            words.append(_TYPE_WORDS[kind])
        elif isinstance(kind, list):
            words += [_TYPE_WORDS.get(str(each), str(each)) for each in kind]
    return " or ".join(dict.fromkeys(words)) or "anything", per_object


def _list_type(root: Node, option: Node, items: list[Node]) -> str:
    low, high = option.get("minItems"), option.get("maxItems")
    count = "" if high is None else f"{low} " if low == high else f"{low or 0} to {high} "
    kinds = {item.get("type") for item in items}
    if kinds <= {"number", "integer"}:
        return f"a list of {count}numbers"
    if "array" in kinds:
        return "a list of lists"
    return f"a list of {count}mappings" if any("properties" in item for item in items) else f"a list of {count}items"


def _unit(root: Node, option: Node) -> str | None:
    if "x-units" in option:
        return "[" + ", ".join(option["x-units"]) + "]"
    if "x-unit" in option:
        return str(option["x-unit"])
    if isinstance(option.get("items"), dict):
        for item in alternatives(root, option["items"]):
            unit = _unit(root, item)
            if unit:
                return unit
    return None


def _values(option: Node) -> list[Any]:
    return [option["const"]] if "const" in option else list(option.get("enum", []))


def _range(option: Node) -> str:
    bounds = [(words, option[bound]) for bound, words in _NUMBER_BOUNDS.items() if bound in option]
    if option.get("exclusiveMinimum", -math.inf) >= option.get("minimum", math.inf):
        bounds = [(words, bound) for words, bound in bounds if words != _NUMBER_BOUNDS["minimum"]]
    return ", ".join(f"{words} {bound:g}" for words, bound in bounds if abs(bound) <= MAX_TOLD)


def _digest(node: Node) -> str:
    return json.dumps(
        {name: value for name, value in node.items() if name not in ("description", "default")}, sort_keys=True
    )
