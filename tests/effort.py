"""How much the quick tests try: a quarter of a property's examples, some of many values; ``nox -s slow`` tries more."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from typing import Any

import pytest
from hypothesis import given, settings

__all__ = ["examples", "for_all", "some"]

THOROUGH = os.environ.get("IRSIM_TESTS") == "thorough"


def examples(count: int) -> int:
    """The argument of ``settings(max_examples=…)`` for a property that is to hold in this number of examples."""
    return count if THOROUGH else count // 4


def for_all(tries: int, /, *drawn: Any, **named: Any) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """A property that is to hold in this number of examples, of which the quick tests try a quarter."""

    def decorate(test: Callable[..., None]) -> Callable[..., None]:
        return settings(max_examples=examples(tries))(given(*drawn, **named)(test))

    return decorate


def some(values: Iterable[Any], every: int = 4) -> list[Any]:
    """Values for ``parametrize``: the quick tests take one of so many, and the gate others each day."""
    later = (pytest.mark.slow, pytest.mark.rotates(every - 1))
    rows = [value if isinstance(value, tuple) else (value,) for value in values]
    return [pytest.param(*row, marks=later if k % every else ()) for k, row in enumerate(rows)]
