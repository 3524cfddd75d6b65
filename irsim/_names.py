"""Modules that only give names from elsewhere, imported when first used."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any

__all__ = ["from_homes"]


def from_homes(module: str, homes: Mapping[str, str]) -> Callable[[str], Any]:
    """The ``__getattr__`` of a module of plain re-exports.

    Args:
        module: Its name.
        homes: Where each name lives; ``module:name`` if it is called otherwise there.
    """

    def get(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {module!r} has no attribute {name!r}")
        home, _, own = homes[name].partition(":")
        return getattr(import_module(home), own or name)

    return get
