"""What rewrites are made of: the register, and ways to go through a scenario and to write it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import yaml

from irsim_evals.grader.scene import Scene

__all__ = ["REWRITES", "Data", "dump", "entries", "rewrite"]

Data = dict[str, Any]
Rewrite = Callable[[str, Data, Scene], str | None]
REWRITES: dict[str, Rewrite] = {}
_DUMPER = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
"""The one in C is ten times as fast; some installations lack it."""


def rewrite(function: Rewrite) -> Rewrite:
    """Register a rewrite under its name."""
    REWRITES[function.__name__] = function
    return function


def dump(data: Data, **options: Any) -> str:
    """A scenario as text."""
    return str(yaml.dump(data, Dumper=_DUMPER, sort_keys=False, allow_unicode=True, **options))


def entries(data: Data) -> list[tuple[str, Data]]:
    """Section and mapping of each entry."""
    found = []
    for section in ("robot", "obstacle"):
        given = data.get(section)
        items = given if isinstance(given, list) else [given] if isinstance(given, dict) else []
        found += [(section, entry) for entry in items if isinstance(entry, dict)]
    return found
