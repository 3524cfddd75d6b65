"""What functions are given, checked before it is used."""

from __future__ import annotations

from operator import index
from typing import Any

from irsim.common.text import clean
from irsim.diagnostics.errors import ArgumentError

__all__ = ["as_given", "is_whole", "whole"]


def is_whole(value: Any) -> bool:
    """Whether a value is an integer, of Python or of NumPy; True and False are none."""
    try:
        index(value)
    except TypeError:
        return False
    return not isinstance(value, bool)


def whole(name: str, value: Any, least: int = 0) -> int:
    """An argument that is a whole number.

    Args:
        name: Of the argument, for the message.
        value: What was given.
        least: Smallest that makes sense.

    Raises:
        ArgumentError: It is something else, or less.
    """
    if not is_whole(value) or value < least:
        raise ArgumentError(f"{name} is {as_given(value)}", f"give a whole number, {least} or more")
    return int(value)


def as_given(value: Any) -> str:
    """A value in a message: as in Python, the beginning if it is long."""
    return clean(repr(value), 60)
