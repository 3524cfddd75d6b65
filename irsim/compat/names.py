"""The public names of IR-SIM 2.12, and which of them are missing here."""

from __future__ import annotations

import dis
import importlib
import json
from functools import cache
from pathlib import Path

__all__ = ["missing_names", "reference_names"]


@cache
def reference_names() -> dict[str, dict[str, list[str] | None]]:
    """``module`` or ``module:Class`` → its public names, and for callables their parameters."""
    text = Path(__file__).with_name("names.json").read_text(encoding="utf-8")
    names: dict[str, dict[str, list[str] | None]] = json.loads(text)
    return names


def missing_names() -> list[str]:
    """``module`` or ``module:Class``, with ``.name`` where only that is missing."""
    missing = []
    for place, names in reference_names().items():
        module, _, owner = place.partition(":")
        try:
            home = importlib.import_module(module)
            home = getattr(home, owner) if owner else home
        except (ImportError, AttributeError):
            missing.append(place)
            continue
        own = _assigned(home) if isinstance(home, type) else frozenset()
        missing += [f"{place}.{name}" for name in names if not hasattr(home, name) and name not in own]
    return missing


def _assigned(home: type) -> frozenset[str]:
    """Attributes that instances have: fields that are declared, and what methods assign."""
    found: set[str] = set()
    for base in home.__mro__:
        found |= set(vars(base).get("__annotations__", ()))
        for method in vars(base).values():
            code = getattr(method, "__code__", None)
            if code is not None:
                found |= {step.argval for step in dis.get_instructions(code) if step.opname == "STORE_ATTR"}
    return frozenset(found)
