"""Writes the reference pages of the skills and the page about IR-SIM: ``python -m irsim.lookup.reference [--check]``.

The pages are generated from the models, registries, templates and codes, like the answers of
:func:`irsim.lookup.lookup`.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import irsim.compat
from irsim.common import data_files as resources
from irsim.common.files import write_atomically
from irsim.lookup.api_pages import PACKS
from irsim.lookup.compatibility import page
from irsim.lookup.pages import pages
from irsim.scenario.model.json_schema import json_schema

__all__ = ["SKILLS", "compatibility", "main", "out_of_date"]

SCENARIO = "irsim-scenario"
SKILLS: dict[str, Callable[[], dict[str, str]]] = {SCENARIO: pages, **PACKS}
"""Skill -> function that returns its pages."""
_BY_HAND = {"irsim-benchmark": ("cluster.md",)}
"""Skill -> pages in the same folder that people write."""


def out_of_date(folder: Path, skill: str = SCENARIO) -> list[Path]:
    """Return the pages that are missing, outdated or superfluous.

    Args:
        folder: Folder of the pages.
        skill: Name of the skill.
    """
    wanted = {folder / f"{name}.md": text for name, text in SKILLS[skill]().items()}
    stale = [path for path, text in wanted.items() if not path.is_file() or path.read_text(encoding="utf-8") != text]
    by_hand = {folder / name for name in _BY_HAND.get(skill, ())}
    return stale + sorted(set(folder.glob("*")) - set(wanted) - by_hand)


def compatibility() -> dict[Path, str]:
    """Return path and text of the page about IR-SIM 2.12."""
    return {Path(irsim.compat.__file__).with_name("README.md"): page(json_schema())}


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the pages, or check them.

    Returns:
        Exit code: 1 if ``--check`` has found outdated pages, else 0.
    """
    parser = argparse.ArgumentParser(prog="python -m irsim.lookup.reference", description=__doc__.partition("\n")[0])
    parser.add_argument("--check", action="store_true", help="write nothing; exit with 1 if pages are out of date")
    folders = {skill: resources.skills_directory() / skill / "references" for skill in SKILLS}
    if parser.parse_args(arguments).check:
        stale = [path for skill, folder in folders.items() for path in out_of_date(folder, skill)] + [
            path for path, text in compatibility().items() if not path.is_file() or path.read_text("utf-8") != text
        ]
        for path in stale:
            print(f"{path} is out of date: run python -m irsim.lookup.reference to update it", file=sys.stderr)
        return 1 if stale else 0
    for skill, folder in folders.items():
        folder.mkdir(parents=True, exist_ok=True)
        for path in out_of_date(folder, skill):
            path.unlink(missing_ok=True)
        for name, text in SKILLS[skill]().items():
            write_atomically(folder / f"{name}.md", text)
    for path, text in compatibility().items():
        write_atomically(path, text)
    print(f"wrote {', '.join(map(str, folders.values()))}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
