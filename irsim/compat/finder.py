"""Finds the modules of IR-SIM 2.12 under their old paths, from the table in :mod:`irsim.compat.paths`."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.machinery import ModuleSpec
from types import CodeType, ModuleType
from typing import Any

from irsim.common.lazy import lazy_names
from irsim.compat.paths import NAMES, SAME, submodules

__all__ = ["OldPathFinder", "install"]


def install() -> None:
    """Put the finder first in ``sys.meta_path``, once.

    It must come before Python's own finder, which would search the folder of an old package's new home and load a
    second copy of what it finds there.
    """
    if not any(isinstance(finder, OldPathFinder) for finder in sys.meta_path):
        sys.meta_path.insert(0, OldPathFinder())


class OldPathFinder:
    """Answers for the listed paths and for nothing else."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The spec of an old path, or None."""
        if not fullname.startswith("irsim."):
            return None
        loader: Any
        if fullname in SAME:
            loader = _AnotherName(SAME[fullname])
        elif fullname in NAMES:
            loader = _ReExports(NAMES[fullname])
        else:
            return None
        return ModuleSpec(fullname, loader, is_package=bool(submodules(fullname)))


class _Loader:
    """Base of the loaders of old paths.

    They do not derive from classes of ``importlib.abc``, because importing these takes longer than importing irsim.
    """

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        """None lets the import system make the module."""
        return None

    def get_source(self, fullname: str) -> str:
        """The program that ``python -m`` runs."""
        raise NotImplementedError

    def get_code(self, fullname: str) -> CodeType:
        """The program that ``python -m`` runs, compiled."""
        return compile(self.get_source(fullname), f"<{fullname}>", "exec")

    def is_package(self, fullname: str) -> bool:
        """Whether modules are found below the path."""
        return bool(submodules(fullname))


class _AnotherName(_Loader):
    """Gives an existing module a second name, so that both paths lead to one object."""

    def __init__(self, home: str) -> None:
        self._home = home
        self._spec: ModuleSpec | None = None

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        module = import_module(self._home)
        self._spec = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        module.__spec__ = self._spec  # the import system has just replaced it with the spec of the old path

    def get_source(self, fullname: str) -> str:
        """One line, which ``python -m`` runs."""
        return f"from {self._home} import *\n"


class _ReExports(_Loader):
    """Makes a module whose names are imported from their homes when they are first used."""

    def __init__(self, homes: dict[str, str]) -> None:
        self._homes = homes

    def exec_module(self, module: ModuleType) -> None:
        own, modules = module.__name__, submodules(module.__name__)
        get, listing = lazy_names(own, self._homes, modules)
        vars(module).update(
            __doc__=f"The names of IR-SIM's ``{own}``; their homes are in ``irsim.compat.paths``.",
            __all__=sorted(self._homes),
            __getattr__=get,
            __dir__=listing,
        )
        homes = set(self._homes.values())
        if len(homes) == 1:  # the path is only imported for what is there, and not in the middle of a script
            import_module(homes.pop().partition(":")[0])
        for name in modules:
            if name in self._homes:  # importing the module later would replace the function of the same name
                import_module(f"{own}.{name}")
                get(name)

    def get_source(self, fullname: str) -> str:
        """One line for each name, which ``python -m`` runs."""
        homes = ((home.partition(":"), name) for name, home in sorted(self._homes.items()))
        return "".join(f"from {home} import {there or name} as {name}\n" for (home, _, there), name in homes)
