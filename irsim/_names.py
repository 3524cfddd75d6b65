"""Modules that only give names from elsewhere, imported when first used."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from importlib import import_module
from importlib.util import find_spec
from typing import Any

__all__ = ["from_homes", "submodule"]


def submodule(package: str, name: str) -> Any:
    """A module of a package, imported when asked for as an attribute; None if there is none."""
    if name.startswith("_") or not hasattr(sys.modules[package], "__path__"):
        return None
    return None if find_spec(f"{package}.{name}") is None else import_module(f"{package}.{name}")


def from_homes(module: str, homes: Mapping[str, str]) -> Callable[[str], Any]:
    """The ``__getattr__`` of a module of plain re-exports.

    Args:
        module: Its name.
        homes: Where each name lives; ``module:name`` if it is called otherwise there.
    """

    def get(name: str) -> Any:
        if name not in homes:
            if (package := submodule(module, name)) is not None:
                return package
            raise AttributeError(f"module {module!r} has no attribute {name!r}")
        home, _, own = homes[name].partition(":")
        return getattr(import_module(home), own or name)

    return get
