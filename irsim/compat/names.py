"""The public names of IR-SIM 2.12, and those among them that irsim lacks."""

from __future__ import annotations

import dis
import importlib
import json
from functools import cache
from pathlib import Path

__all__ = ["missing_names", "reference_names"]


@cache
def reference_names() -> dict[str, dict[str, list[str] | None]]:
    """Return the public names of each ``module`` and ``module:Class``, and the parameters of callables."""
    text = Path(__file__).with_name("names.json").read_text(encoding="utf-8")
    names: dict[str, dict[str, list[str] | None]] = json.loads(text)
    return names


def missing_names() -> list[str]:
    """Return the names of 2.12 that irsim lacks: ``module``, ``module:Class``, or either followed by ``.name``."""
    missing = []
    for place, names in reference_names().items():
        module, _, owner = place.partition(":")
        try:
            home = importlib.import_module(module)
            home = getattr(home, owner) if owner else home
        except (ImportError, AttributeError):
            missing.append(place)
            continue
        own = _instance_attributes(home) if isinstance(home, type) else frozenset()
        missing += [f"{place}.{name}" for name in names if not hasattr(home, name) and name not in own]
    return missing


def _instance_attributes(home: type) -> frozenset[str]:
    """Return the attributes of instances: declared fields, and attributes that methods assign."""
    attributes: set[str] = set()
    for base in home.__mro__:
        attributes |= set(vars(base).get("__annotations__", ()))
        for method in vars(base).values():
            code = getattr(method, "__code__", None)
            if code is not None:
                attributes |= {step.argval for step in dis.get_instructions(code) if step.opname == "STORE_ATTR"}
    return frozenset(attributes)
