"""Writes the stub package ``irsim-stubs``, through which type checkers and editors see the old module paths.

``python irsim/compat/stubs.py FOLDER`` runs when a package is built, before irsim can be imported.
"""

from __future__ import annotations

import runpy
import sys
from pathlib import Path
from typing import Any

__all__ = ["stub_files", "write_stubs"]


def stub_files() -> dict[str, str]:
    """Path below ``irsim-stubs`` -> text of every stub, from the table beside this file."""
    table: dict[str, Any] = runpy.run_path(str(Path(__file__).with_name("paths.py")))
    same, names = table["SAME"], table["NAMES"]
    files = {"py.typed": "partial\n"}
    for path in table["old_paths"]():
        ending = "/__init__.pyi" if table["submodules"](path) else ".pyi"
        file = path.removeprefix("irsim.").replace(".", "/") + ending
        if path in same:
            files[file] = f"from {same[path]} import *\n"
        else:
            files[file] = "".join(_import(name, home) for name, home in sorted(names[path].items()))
    return files


def _import(name: str, home: str) -> str:
    module, _, name_there = home.partition(":")
    return f"from {module} import {name_there or name} as {name}\n"


def write_stubs(folder: Path) -> None:
    """Write the stubs into ``folder``."""
    for name, text in stub_files().items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    write_stubs(Path(sys.argv[1]))
