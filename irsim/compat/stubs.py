"""Writes the stub package ``irsim-stubs``, through which type checkers and editors see the old module paths.

``python irsim/compat/stubs.py FOLDER`` runs when a package is built, before irsim can be imported.
"""

from __future__ import annotations

import sys
from pathlib import Path

__all__ = ["stub_files", "write_stubs"]


def stub_files(same: dict[str, str], names: dict[str, dict[str, str]]) -> dict[str, str]:
    """Path below ``irsim-stubs`` -> text of every stub.

    Args:
        same: ``SAME`` of :mod:`irsim.compat.paths`.
        names: ``NAMES`` of that module.
    """
    files = {"py.typed": "partial\n"}
    paths = {*same, *names}
    for path in sorted(paths):
        is_package = any(other.startswith(f"{path}.") for other in paths)
        file = path.removeprefix("irsim.").replace(".", "/") + ("/__init__.pyi" if is_package else ".pyi")
        if path in same:
            files[file] = f"from {same[path]} import *\n"
        else:
            files[file] = "".join(_import(name, home) for name, home in sorted(names[path].items()))
    return files


def _import(name: str, home: str) -> str:
    module, _, name_there = home.partition(":")
    return f"from {module} import {name_there or name} as {name}\n"


def write_stubs(folder: Path) -> None:
    """Write the stubs into ``folder``, from the table beside this file."""
    table: dict[str, dict[str, object]] = {}
    exec(Path(__file__).with_name("paths.py").read_text(encoding="utf-8"), table)
    for name, text in stub_files(table["SAME"], table["NAMES"]).items():  # type: ignore[arg-type]
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    write_stubs(Path(sys.argv[1]))
