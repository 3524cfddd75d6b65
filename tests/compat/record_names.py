"""Record again the public names of PyPI's ir-sim 2.12.0, and parameters of its callables, in irsim/compat/names.json.

REFERENCE tests/compat/record_names.py        # with an interpreter that has ir-sim installed
"""

from __future__ import annotations

import importlib
import inspect
import json
from pathlib import Path

PACKAGES = {
    *("irsim", "irsim.env", "irsim.world", "irsim.world.map", "irsim.world.sensors", "irsim.lib", "irsim.lib.behavior"),
    *("irsim.lib.behavior.behavior_registry", "irsim.lib.behavior.behavior_methods", "irsim.lib.path_planners"),
    *("irsim.util", "irsim.util.util", "irsim.util.random", "irsim.config", "irsim.gui", "irsim.msg"),
}
"""Modules whose names count wherever they are defined; of other modules only what they define counts."""


def parameters(item: object) -> list[str] | None:
    """Names of the parameters of a callable, or None."""
    try:
        return [name for name in inspect.signature(item).parameters if name != "self"]  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return None


def names_of(item: object) -> dict[str, list[str] | None]:
    """Public attributes of a class, or names made in a module."""
    names: dict[str, list[str] | None] = {}
    for name in sorted(vars(item) if inspect.ismodule(item) else dir(item)):
        value = getattr(item, name, None)
        if name.startswith("_") or inspect.ismodule(value):
            continue
        home = getattr(value, "__module__", None)
        if inspect.ismodule(item) and not str(home or "irsim").startswith("irsim"):
            continue
        names[name] = parameters(value) if callable(value) else None
    return names


def main() -> None:
    """Write the file, for the modules and classes that it has."""
    path = Path(__file__).parents[2] / "irsim" / "compat" / "names.json"
    names = {}
    for place in json.loads(path.read_text(encoding="utf-8")):
        module, _, owner = place.partition(":")
        home = importlib.import_module(module)
        names[place] = own = names_of(getattr(home, owner) if owner else home)
        if not owner and module not in PACKAGES:
            names[place] = {name: own[name] for name in own if getattr(vars(home)[name], "__module__", "") == module}
    path.write_text(json.dumps(names, indent=1, sort_keys=True) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
