"""Data structures of the YAML reader: marks and nodes hold positions, frames hold unfinished collections."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

__all__ = ["NO_KEY", "Anchored", "Frame", "Mark", "Node", "merge", "scalar_mark", "start_mark"]

NO_KEY = object()
"""Stands for a key that has not been read yet."""


@dataclass(frozen=True, slots=True)
class Mark:
    """A place in the text, counted from 1, and how many characters to underline."""

    line: int
    column: int
    length: int = 1


@dataclass(slots=True)
class Node:
    """Positions of a value, its keys and its parts."""

    mark: Mark
    keys: dict[Any, Mark] = field(default_factory=dict)
    children: dict[Any, Node] = field(default_factory=dict)


@dataclass(slots=True)
class Frame:
    """A list or mapping that is still being read."""

    value: Any
    mapping: bool
    anchor: str | None
    node: Node | None
    key: Any = NO_KEY
    key_mark: Mark | None = None
    size: int = 1
    height: int = 1
    merges: list[tuple[Any, Node | None]] | None = None


@dataclass(slots=True)
class Anchored:
    """A value with an anchor, and its size and depth when an alias repeats it."""

    value: Any
    size: int
    height: int
    node: Node | None


def merge(frame: Frame) -> None:
    """Add the pairs of merged mappings to a mapping; its own pairs take precedence."""
    own, merged = dict(frame.value), frame.value
    merged.clear()
    for source, node in frame.merges or []:
        merged.update(source)
        if node is not None and frame.node is not None:
            for key, child in node.children.items():
                if key not in own:
                    frame.node.children[key] = child
                    frame.node.keys[key] = node.keys[key]
    merged.update(own)


def start_mark(event: Any) -> Mark:
    """Position where a list or mapping begins."""
    return Mark(event.start_mark.line + 1, event.start_mark.column + 1, 1)


def scalar_mark(event: Any) -> Mark:
    """Position and length of a scalar."""
    start, end = event.start_mark, event.end_mark
    length = end.column - start.column if end.line == start.line else 1
    return Mark(start.line + 1, start.column + 1, max(1, length))
