"""Writes the references of the agent skills and the page on IR-SIM: ``python -m irsim.lookup.reference [--check]``.

They are generated from the models, registries, templates and codes, as the answers of :func:`irsim.lookup.lookup` are.
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
"""What makes the pages of each skill."""


def out_of_date(folder: Path, skill: str = SCENARIO) -> list[Path]:
    """Pages that are missing, differ from what would be written, or should not be there.

    Args:
        folder: Where the pages are.
        skill: Of which skill.
    """
    wanted = {folder / f"{name}.md": text for name, text in SKILLS[skill]().items()}
    stale = [path for path, text in wanted.items() if not path.is_file() or path.read_text(encoding="utf-8") != text]
    return stale + sorted(set(folder.glob("*")) - set(wanted))


def compatibility() -> dict[Path, str]:
    """Where the page about IR-SIM 2.12 is, and what it should say."""
    return {Path(irsim.compat.__file__).with_name("README.md"): page(json_schema())}


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the pages, or check them.

    Returns:
        0, or 1 if ``--check`` found some out of date.
    """
    parser = argparse.ArgumentParser(prog="python -m irsim.lookup.reference", description=__doc__.partition("\n")[0])
    parser.add_argument("--check", action="store_true", help="write nothing; exit with 1 if pages are out of date")
    folders = {skill: resources.skills_directory() / skill / "references" for skill in SKILLS}
    if parser.parse_args(arguments).check:
        stale = [path for skill, folder in folders.items() for path in out_of_date(folder, skill)] + [
            path for path, text in compatibility().items() if not path.is_file() or path.read_text("utf-8") != text
        ]
        for path in stale:
            print(f"{path} is out of date; python -m irsim.lookup.reference writes it again", file=sys.stderr)
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
