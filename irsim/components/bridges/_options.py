"""Options that bridges have in common, and how a bridge is opened from them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any, ClassVar, Literal

from irsim.options.base import Options

__all__ = ["BridgeOptions", "opened_by"]


class BridgeOptions(Options):
    """A connection to another program."""

    files: ClassVar[tuple[str, ...]] = ()
    """Keys that name files or folders to write."""

    objects: ClassVar[tuple[str, ...]] = ()
    """Keys that name objects of the scenario."""
    robots_only: ClassVar[tuple[str, ...]] = ()
    """The keys among these that name robots."""

    name: str
    """Name of the bridge."""
    clock: Literal["irsim", "external", "wall"] = "irsim"
    """Who decides when a step is: `irsim` steps as fast as it can and the other program follows, `external` waits for
    the other program before each step, `wall` steps in real time."""

    def driven(self, robots: Sequence[str]) -> Sequence[str]:
        """Which of the robots with these names the other program may drive by commands."""
        return ()


def opened_by(package: str) -> Callable[[Any], Any]:
    """Function that makes the bridge of some options: ``make`` of ``irsim.bridges.<package>.bridge``.

    The module is imported when the bridge is opened, because it may need libraries that few users have.
    """

    def opened(options: Any) -> Any:
        return import_module(f"irsim.bridges.{package}.bridge").make(options)

    return opened
