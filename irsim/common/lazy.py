"""Names that are imported when they are first used, modules of a folder, and attributes that a function computes."""

from __future__ import annotations

import pkgutil
import sys
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, Generic, TypeVar, overload

__all__ = ["PUBLIC_HOMES", "call_home", "computed", "lazy_names", "module_names"]

PUBLIC_HOMES = {
    "Batch": "irsim.env.batch",
    "Env": "irsim.env",
    "EnvBase": "irsim.env",
    "EnvBase3D": "irsim.env",
    "IrsimError": "irsim.diagnostics.errors",
    "NotSimulatedError": "irsim.diagnostics.errors",
    "PlacementError": "irsim.diagnostics.errors",
    "Policy": "irsim.policies",
    "ScenarioError": "irsim.diagnostics.errors",
    "ScenarioNotFoundError": "irsim.diagnostics.errors",
    "batch": "irsim.env.batch",
    "benchmark": "irsim.benchmarks",
    "connect": "irsim.bridges.connect",
    "diff": "irsim.api",
    "diff_runs": "irsim.runs.comparison",
    "episodes": "irsim.api.run_controller",
    "export_run": "irsim.bridges.export.export",
    "fix": "irsim.api",
    "make": "irsim.env",
    "open_policy": "irsim.policies",
    "register_behavior": "irsim.objects.extensions.registration",
    "render": "irsim.api",
    "replay": "irsim.runs.replay.export",
    "run": "irsim.api",
    "validate": "irsim.api",
}
"""Name -> the module that it is imported from when it is first used."""
_ELSEWHERE = {
    "ParallelEnv": "irsim.learning.ParallelEnv",
    "SB3VecEnv": "irsim.learning.SB3VecEnv",
    "Task": "irsim.learning.Task",
    "TorchRLEnv": "irsim.learning.TorchRLEnv",
    "VectorEnv": "irsim.learning.VectorEnv",
    "export": "irsim.export_run",
    "load": "irsim.make",
    "load_policy": "irsim.open_policy",
    "make_env": "irsim.make",
    "make_vec": "irsim.learning.VectorEnv",
    "make_vec_env": "irsim.learning.VectorEnv",
    "simulate": "irsim.run",
    "train": "the command irsim train",
    "vector": "irsim.learning.VectorEnv",
}
"""Name that other libraries or packages of irsim have, but not ``irsim`` -> what to use."""


@cache
def module_names(package: str) -> tuple[str, ...]:
    """Names of the modules of a package, sorted; modules that begin with an underscore help the others."""
    modules = pkgutil.iter_modules(import_module(package).__path__)
    return tuple(sorted(info.name for info in modules if not info.name.startswith("_")))


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
            hint = f": use {meant}" if package == "irsim" and (meant := _ELSEWHERE.get(name)) else ""
            raise AttributeError(f"module {package!r} has no attribute {name!r}{hint}")
        setattr(sys.modules[package], name, value)
        return value

    def listing() -> list[str]:
        return sorted({*vars(sys.modules[package]), *homes, *own_modules})

    return get, listing


def call_home(home: str, *args: Any, **kwargs: Any) -> Any:
    """Call a function of a module that is imported at the call, for methods of data whose work needs other rooms.

    Args:
        home: ``module:function``.
        *args: Arguments of the function.
        **kwargs: Further arguments.
    """
    module, _, name = home.partition(":")
    return getattr(import_module(module), name)(*args, **kwargs)


Value = TypeVar("Value")


class computed(property, Generic[Value]):
    """A read-only attribute whose value a function computes from the instance: ``robot = computed(queries.robot)``.

    It is a :class:`property` whose type is the return type of the function, so that type checkers and editors know it.
    """

    if TYPE_CHECKING:

        def __init__(self, fget: Callable[[Any], Value]) -> None: ...

        @overload
        def __get__(self, instance: None, owner: type | None = None) -> computed[Value]: ...

        @overload
        def __get__(self, instance: Any, owner: type | None = None) -> Value: ...

        def __get__(self, instance: Any, owner: type | None = None) -> Any: ...
