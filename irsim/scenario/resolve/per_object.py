"""How the value of a key is spread over the objects of an entry (the same rule for every key, with few exceptions)."""

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
    "mass": "number",
    "friction": "number",
    "inertia": "number",
    "restitution": "number",
}


def kind_of(key: str) -> Kind:
    """What one value of an entry's key is; ``value`` is the general rule."""
    return _EXCEPTIONS.get(key, "value")


def spread(value: Any, count: int, kind: Kind = "value") -> list[Any]:
    """The value each of ``count`` objects gets.

    The general rule (``kind="value"``):

    * what is not a list, and a list of numbers only (one vector; the empty list too), goes to every object;
    * of any other list object i gets element i. A shorter list repeats its last element, of a longer one the rest
      is dropped.

    Args:
        value: As written or validated; it is never changed.
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
    """Whether a value holds one value per object."""
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
    """Validated colors are tuples of floats, which is a vector."""
    return isinstance(value, tuple) and is_vector(value)
