"""Where values stand in a text of YAML, as PyYAML's nodes say, and whether two texts have the same data."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import yaml

from irsim.diagnostics.diagnostic import Path

__all__ = ["LOADER", "end_of", "is_key", "node_at", "same_data"]

LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
"""The loader of PyYAML that gives positions; nothing is constructed with it from files of users."""


def is_key(node: yaml.Node, part: str | int) -> bool:
    """Whether a node is the key that a part of a path names."""
    return isinstance(node, yaml.ScalarNode) and node.value == str(part)


def node_at(node: yaml.Node | None, path: Path) -> yaml.Node:
    """The node at a path below a node.

    Raises:
        KeyError, IndexError: The path leads nowhere.
    """
    for part in path:
        if isinstance(node, yaml.MappingNode):
            node = next((value for key, value in node.value if is_key(key, part)), None)
        elif isinstance(node, yaml.SequenceNode) and isinstance(part, int):
            node = node.value[part]
        else:
            raise KeyError(part)
    if node is None:
        raise KeyError(path)
    return node


def end_of(node: yaml.Node) -> int:
    """Index where the text of a node ends; the end mark of a block would include the comments behind it."""
    if isinstance(node, yaml.MappingNode) and not node.flow_style and node.value:
        return max(end_of(node.value[-1][1]), end_of(node.value[-1][0]))
    if isinstance(node, yaml.SequenceNode) and not node.flow_style and node.value:
        return end_of(node.value[-1])
    return int(node.end_mark.index)


def same_data(a: Any, b: Any, *, near: float = 0.0) -> bool:
    """Whether data are equal, value by value and type by type: 1 is not true, and is 1.0.

    Args:
        a: Data.
        b: Data.
        near: Difference up to which numbers count as equal, beside the difference of rounding.
    """
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return set(a) == set(b) and all(same_data(a[key], b[key], near=near) for key in a)
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return len(a) == len(b) and all(same_data(x, y, near=near) for x, y in zip(a, b, strict=True))
    if isinstance(a, bool) or isinstance(b, bool) or not (isinstance(a, (int, float)) and isinstance(b, (int, float))):
        return type(a) is type(b) and bool(a == b)
    if a == b:
        return True
    rounded = 1e-9 * abs(a) if isinstance(a, float) and isinstance(b, float) else 0.0
    tolerance = max(near, rounded)
    return tolerance > 0 and abs(a - b) <= tolerance  # whole numbers of any size are only compared
