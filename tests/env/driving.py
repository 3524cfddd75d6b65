"""Helpers of tests that drive an environment."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

__all__ = ["Make", "take_steps"]

Make = Callable[..., Any]
"""Type of the fixtures ``make``: text of a scenario and options → environment."""


def take_steps(env: Any, number: int, *action: Any) -> None:
    """Step an environment a number of times, with the same action each time."""
    for _ in range(number):
        env.step(*action)
