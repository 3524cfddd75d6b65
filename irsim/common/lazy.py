"""Packages whose names are imported when they are first used."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from typing import Any

__all__ = ["lazy_names"]


def lazy_names(
    package: str, homes: Mapping[str, str], modules: Iterable[str] = ()
) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """The ``__getattr__`` and ``__dir__`` of a package that imports its names when they are first used.

    Args:
        package: Name of the package.
        homes: Name -> module that defines it, or ``module:name`` if it has another name there.
        modules: Modules of the package that are its attributes, even if they have not been imported yet. Where a name
            and a module are the same word, the name wins.
    """
    own_modules = frozenset(modules)

    def get(name: str) -> Any:
        if name in homes:
            home, _, name_there = homes[name].partition(":")
            value = getattr(import_module(home), name_there or name)
        elif name in own_modules:
            value = import_module(f"{package}.{name}")
        else:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        setattr(sys.modules[package], name, value)
        return value

    def listing() -> list[str]:
        return sorted({*vars(sys.modules[package]), *homes, *own_modules})

    return get, listing
