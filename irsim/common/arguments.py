"""Checks arguments before they are used."""

from __future__ import annotations

from operator import index
from typing import Any, TypeGuard

from irsim.common.text import clean
from irsim.diagnostics.errors import InputError

__all__ = ["as_given", "check_positive", "check_steps", "check_whole_number", "is_number", "is_whole_number"]


def is_number(value: Any) -> TypeGuard[int | float]:
    """Whether a value is a number of Python; True and False do not count."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def is_whole_number(value: Any) -> bool:
    """Whether a value is an integer, of Python or of NumPy; True and False do not count."""
    try:
        index(value)
    except TypeError:
        return False
    return not isinstance(value, bool)


def check_whole_number(name: str, value: Any, least: int = 0) -> int:
    """The value of an argument that must be a whole number.

    Args:
        name: Name of the argument, for the message.
        value: The argument.
        least: Smallest valid value.

    Raises:
        InputError: The value is not a whole number, or less than ``least``.
    """
    if not is_whole_number(value) or value < least:
        raise InputError(f"{name} cannot be {as_given(value)}", f"give a whole number, {least} or more")
    return int(value)


def check_steps(value: Any) -> int:
    """The number of periods to advance, at most the largest that the core counts.

    Raises:
        InputError: The value is not a whole number, or negative.
    """
    return min(check_whole_number("steps", value), 2**63 - 1)


def check_positive(**values: float | None) -> None:
    """Refuse arguments other than positive numbers of a size that occurs; None stands for a default.

    Raises:
        InputError: A value is less than 1e-6, greater than 1e9 or not a number.
    """
    for name, value in values.items():
        if value is not None and not 1e-6 <= value <= 1e9:
            raise InputError(f"{name} must be a positive number, got {value}", f"give a {name} from 1e-6 to 1e9")


def as_given(value: Any) -> str:
    """A value for a message, as in Python, cut if it is long."""
    return clean(repr(value), 60)
