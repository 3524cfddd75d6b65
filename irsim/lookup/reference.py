"""Writes the reference pages of the skills and the page about IR-SIM: ``python -m irsim.lookup.reference [--check]``.

The pages are generated from the models, registries, templates and codes, like the answers of
:func:`irsim.lookup.lookup`.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import irsim.compat
from irsim.common import data_files as resources
from irsim.common.files import write_atomically
from irsim.compat.absent import ABSENT
from irsim.compat.differences import (
    CHANGED_SCENES,
    DIFFERENCES,
    EXTENSIONS,
    FEATURES,
    KEY_DIFFERENCES,
    NAME_DIFFERENCES,
)
from irsim.compat.names import reference_names
from irsim.lookup.answer import plain_table
from irsim.lookup.api_pages import PACKS
from irsim.lookup.pages import pages
from irsim.lookup.schema_walk import Node, mappings
from irsim.options.registry import REGISTRIES
from irsim.scenario.model.json_schema import json_schema

__all__ = ["SKILLS", "compatibility", "main", "out_of_date", "page"]


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


_INTRO = (
    "Scenario files and Python programs for IR-SIM 2.12 run without changes. *same* means the same meaning, defaults, "
    "units and array shapes. An id refers to an intended difference in the first table. *added* marks optional keys "
    "of irsim, which do not change the meaning of existing files."
)

_SCENES = (
    "These scenes of irsim itself moved in another way before the difference. All other templates and all scenes "
    "recorded from 2.12 move as before; its recorded decisions, too, with `turning: fixed`, `keep_gap: false`, and "
    "without static lines (D6) and `acce` (D28)."
)


def page(schema: Node) -> str:
    """Return the page as Markdown.

    Args:
        schema: JSON Schema of the language.
    """
    ids = [(f"`{name}`", one.theirs, one.ours, one.why) for name, one in DIFFERENCES.items()]
    scenes = [(f"`{place}`", difference, why) for place, (difference, why) in CHANGED_SCENES.items()]
    parts = [
        "# Compatibility with IR-SIM 2.12",
        "<!-- Written by `python -m irsim.lookup.reference`: do not edit. -->",
        _INTRO,
        "## Intended differences\n\n" + plain_table(("id", "IR-SIM 2.12", "irsim", "why"), ids),
        f"## Scenes that move otherwise\n\n{_SCENES}\n\n" + plain_table(("scene", "id", "why"), scenes),
        "## Keys of scenarios\n\n" + plain_table(("key", "compared with 2.12"), _keys(schema)),
    ]
    parts += [
        f"## `{place.replace(':', '.')}`\n\n" + plain_table(("name", "compared with 2.12"), rows)
        for place, rows in _names()
    ]
    return "\n\n".join(part.strip() for part in parts) + "\n"


def _keys(schema: Node) -> list[tuple[str, str]]:
    language = max(mappings(schema, schema), key=lambda option: len(option["properties"]))["properties"]
    rows: list[tuple[str, str]] = []
    for section, name in (("world", "world"), ("robot", "entry")):
        [keys] = [option["properties"] for option in mappings(schema, language[section])]
        rows += [_key_row(f"{name}.{key}") for key in keys]
    for kind, registry in sorted(REGISTRIES.items()):
        for feature in registry.features():
            place = f"{kind}.{feature.name}"
            keys = [f"{place}.{key}" for key in feature.options.model_fields if key != "name"]
            if feature.name not in FEATURES[kind]:
                rows += [(f"`{one}`", f"added: {EXTENSIONS.get(place, 'of irsim')}") for one in (place, *keys)]
            else:
                rows += [_key_row(place), *(_key_row(key, kind) for key in keys)]
    return rows


def _key_row(place: str, kind: str = "") -> tuple[str, str]:
    short = f"{kind}.{place.rpartition('.')[2]}" if kind else place
    owner = place.rpartition(".")[0]
    added = EXTENSIONS.get(place) or (EXTENSIONS.get(owner) if kind else None)
    if added is not None:
        return f"`{place}`", f"added: {added}"
    return f"`{place}`", KEY_DIFFERENCES.get(place) or KEY_DIFFERENCES.get(short) or "same"


def _names() -> Iterator[tuple[str, list[tuple[str, str]]]]:
    for place, names in reference_names().items():
        owner = place.partition(":")[2] or place
        rows = []
        for name in names:
            difference = NAME_DIFFERENCES.get(f"{owner}.{name}", "same")
            absent = ABSENT.get(f"{place}.{name}") or ABSENT.get(place)
            rows.append((f"`{name}`", f"missing: {absent}" if absent else difference))
        if rows:
            yield place, rows


if __name__ == "__main__":
    sys.exit(main())
