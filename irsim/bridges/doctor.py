"""Which bridges can be used on this machine, tested over the loopback where that is possible."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from typing import Literal

from irsim.options.registry import BRIDGES

__all__ = ["Health", "Part", "examine"]


@dataclass(frozen=True)
class Part:
    """A library of a bridge.

    Attributes:
        module: Its top-level module.
        package: Its name in the package registry; None if it comes with a system, such as ROS.
        extra: The extra of ``irsim-mcp`` that installs it, or how it is installed.
        self_test: Function that uses it on this machine alone, and returns one sentence; None without one.
    """

    module: str
    package: str | None
    extra: str
    self_test: Callable[[], str] | None = None


@dataclass(frozen=True)
class Health:
    """What was found out about a bridge, or about one of its backends.

    Attributes:
        bridge: Name of the bridge.
        part: Name of the library; empty for a bridge that needs none.
        state: ``ready`` (its test passed), ``there`` (it has no test), ``missing`` or ``broken``.
        version: Version of the library, or empty.
        text: What the test did, what failed, or the command that installs the library.
    """

    bridge: str
    part: str
    state: Literal["ready", "there", "missing", "broken"]
    version: str = ""
    text: str = field(default="")


def examine(names: Sequence[str] = ()) -> list[Health]:
    """Look at bridges: which libraries are there, and whether they work on this machine.

    A module ``irsim.bridges.<name>.doctor`` has ``PARTS``, the libraries of the bridge.

    Args:
        names: Names of bridges; default: all.
    """
    found = []
    for name in names or BRIDGES.names():
        feature = BRIDGES.get(name)
        if feature is None:
            found.append(
                Health(name, "", "missing", text=f"there is no such bridge; they are {', '.join(BRIDGES.names())}")
            )
            continue
        module = f"irsim.bridges.{name}.doctor"
        parts: Sequence[Part] = import_module(module).PARTS if _exists(module) else ()
        found += [_look(name, part) for part in parts] or [Health(name, "", "there", text="it needs no library")]
    return found


def _look(name: str, part: Part) -> Health:
    if not _exists(part.module):
        how = f"pip install 'irsim-mcp[{part.extra}]'" if part.package is not None else part.extra
        return Health(name, part.module, "missing", text=how)
    number = ""
    if part.package is not None:
        try:
            number = version(part.package)
        except PackageNotFoundError:
            number = "?"
    if part.self_test is None:
        return Health(name, part.module, "there", number)
    try:
        return Health(name, part.module, "ready", number, part.self_test())
    except Exception as error:  # a library of others may raise anything; that is what is examined
        return Health(name, part.module, "broken", number, f"{type(error).__name__}: {error}")


def _exists(module: str) -> bool:
    try:
        return find_spec(module) is not None
    except ModuleNotFoundError:
        return False
