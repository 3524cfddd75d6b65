"""Spreads the value of a key over the objects of an entry, by one rule with few exceptions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

from irsim.options.vectors import is_vector

__all__ = ["Kind", "is_per_object", "kind_of", "spread"]

Kind = Literal["value", "number", "list", "path"]

_EXCEPTIONS: dict[str, Kind] = {
    "sensors": "list",
    "tags": "list",
    "waypoints": "path",
    "start_time": "number",
    "appear_time": "number",
    "mass": "number",
    "friction": "number",
    "inertia": "number",
    "restitution": "number",
}


def kind_of(key: str) -> Kind:
    """The kind of value that an entry's key takes; ``value`` is the general rule."""
    return _EXCEPTIONS.get(key, "value")


def spread(value: Any, count: int, kind: Kind = "value") -> list[Any]:
    """The value that each of ``count`` objects gets.

    The general rule (``kind="value"``):

    * a value that is not a list, and a list of only numbers (one vector; also the empty list), goes to every object;
    * of any other list, object i gets element i. A short list repeats its last element, a long list is cut.

    Args:
        value: The value, as written or validated; it is not changed.
        count: Number of objects, not negative.
        kind: ``number``: one value is a number, so a list of numbers is one per object. ``list``: one value is a
            list (of sensors, of tags), so only a list that holds lists is one per object. ``path``: one value is a
            list of vectors, so only a list that holds lists of vectors is one per object.

    Returns:
        ``count`` values.
    """
    if not is_per_object(value, kind):
        return [value] * count
    last = len(value) - 1
    return [value[min(i, last)] for i in range(count)]


def is_per_object(value: Any, kind: Kind = "value") -> bool:
    """Whether a value is a list with one value per object."""
    if not isinstance(value, (list, tuple)) or not value or _is_color(value):
        return False
    if kind == "list":
        return _holds_list(value)
    if kind == "path":
        return any(_holds_list(item) for item in value)
    return kind == "number" or not is_vector(value)


def _holds_list(value: Any) -> bool:
    return isinstance(value, Sequence) and any(isinstance(item, (list, tuple)) for item in value)


def _is_color(value: Any) -> bool:
    """Whether a value is a validated colour, which is a tuple of floats."""
    return isinstance(value, tuple) and is_vector(value)
