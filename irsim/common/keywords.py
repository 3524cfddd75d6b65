"""Misspelt keyword arguments are answered with the name that was probably meant."""

from __future__ import annotations

import functools
from collections.abc import Callable
from difflib import get_close_matches
from typing import Any, ParamSpec, TypeVar

from irsim.common.text import clean

__all__ = ["answers_misspelt"]

P = ParamSpec("P")
R = TypeVar("R")


def answers_misspelt(function: Callable[P, R]) -> Callable[P, R]:
    """Decorate a function, so that the TypeError about an unknown keyword names the nearest one, as newer Pythons do.

    Editors and type checkers see the signature of the function itself.
    """
    code: Any = getattr(function, "__code__")  # noqa: B009 - the type Callable does not have it
    known = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]

    @functools.wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        for name in kwargs:
            if name not in known:
                raise _unknown(function.__qualname__.removesuffix(".__init__"), name, known)
        return function(*args, **kwargs)

    return call


def _unknown(function: str, name: str, known: tuple[str, ...]) -> TypeError:
    shown = [one for one in known if one != "self"]
    near = get_close_matches(name, shown, 1)
    help_ = f"Did you mean '{near[0]}'?" if near else f"Known are {', '.join(shown)}."
    return TypeError(f"{function}() got an unexpected keyword argument '{clean(name)}'. {help_}")
