"""A key that several components have, asked for without the name of one of them: ``robot.sensors.range_max``."""

from __future__ import annotations

import functools
from collections.abc import Sequence

from irsim.common.text import listed
from irsim.lookup.answer import Key
from irsim.lookup.schema_walk import Node, component_name, key, mappings, step
from irsim.options.registry import reading_order

__all__ = ["every_name", "meanings", "same_key_of"]


def every_name(schema: Node, path: tuple[str, ...]) -> Key | None:
    """The key ``name`` with the names of all components that it may choose; None for another key."""
    names = list(_owners(schema, path)) if path[-1] == "name" else []
    if len(names) < 2:
        return None
    about = key(schema, "name", _owners(schema, path)[names[0]])
    return about.model_copy(update={"default": None, "allowed": listed(sorted(names), len(names))})


def meanings(schema: Node, path: tuple[str, ...]) -> list[Key]:
    """The key once for each meaning, the best-known component first; empty if it has the same in all of them.

    The key ``name``, of which each component has its own, is in :func:`every_name`.
    """
    meanings: dict[str, tuple[Key, list[str]]] = {}
    for name, node in _owners(schema, path).items():
        about = key(schema, path[-1], node)
        meanings.setdefault(about.model_dump_json(), (about, []))[1].append(name)
    if len(meanings) < 2 or path[-1] == "name":
        return []
    lines = []
    for about, owners in meanings.values():
        names = [f"{owner}.{path[-1]}" for owner in owners]
        text = f"{about.text}{same_key_of(names[0], names)}"
        lines.append(about.model_copy(update={"name": names[0], "text": text}))
    return lines


def same_key_of(first: str, names: Sequence[str]) -> str:
    """Say in which other places a key has the same meaning, by the parts of their paths that differ."""
    start = first.split(".")
    others = []
    for name in names:
        words = name.split(".")
        shared = next((k for k, (a, b) in enumerate(zip(words, start, strict=False)) if a != b), len(start) - 1)
        others += [".".join(words[shared:-1]) or ".".join(words[:-1])] if name != first else []
    return f" The same key of {', '.join(others)}." if others else ""


def _owners(schema: Node, path: tuple[str, ...]) -> dict[str, Node]:
    """Components at the end of a path without its last word -> their key of that name."""
    parents = functools.reduce(lambda nodes, word: step(schema, nodes, word), path[:-1], [schema])
    options = [option for node in parents for option in mappings(schema, node) if path[-1] in option["properties"]]
    named = {name: option["properties"][path[-1]] for option in options if (name := component_name(option))}
    return {name: named[name] for name in sorted(named, key=reading_order)}
