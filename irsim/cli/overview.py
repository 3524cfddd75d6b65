"""Writes what is known of commands without importing them: ``python -m irsim.cli.overview README.md``.

That is the table of commands in the README, and their first sentences, which ``irsim --help`` shows.
"""

from __future__ import annotations

import inspect
import json
import re
import sys
from pathlib import Path

import typer

from irsim.cli.app import COMMANDS, loaded

__all__ = ["SENTENCES_FILE", "commands_table", "sentences_text", "update"]

_BEGIN, _END = "<!-- begin commands -->\n", "<!-- end commands -->"
SENTENCES_FILE = Path(__file__).with_name("sentences.py")


def commands_table() -> str:
    """Return a Markdown table with one row per command: its name and the first paragraph of its help."""
    rows = ["| command | what it does |", "|---|---|"]
    groups = []
    for name in COMMANDS:
        entry = loaded(name)
        if isinstance(entry, typer.Typer):
            groups.append((name, entry))
        else:
            rows.append(f"| `irsim {name}` | {_first(entry)} |")
    for name, group in groups:
        for command in group.registered_commands:
            assert command.callback is not None
            rows.append(f"| `irsim {name} {command.name or command.callback.__name__}` | {_first(command.callback)} |")
    return "\n".join(rows) + "\n"


def _first(command: object) -> str:
    return inspect.cleandoc(command.__doc__ or "").partition("\n\n")[0].replace("\n", " ")


def sentences_text() -> str:
    """Return the module with the first sentence of each command or group."""
    lines = []
    for name in COMMANDS:
        entry = loaded(name)
        lines.append(
            f'    "{name}": {json.dumps(entry.info.help if isinstance(entry, typer.Typer) else _first(entry))},'
        )
    head = [
        "# ruff: noqa: E501",
        '"""First sentences of the commands; ``python -m irsim.cli.overview README.md`` writes this file."""',
        "",
        "SENTENCES = {",
    ]
    return "\n".join([*head, *lines, "}"]) + "\n"


def update(readme: Path) -> None:
    """Write the sentences, and the table between the markers of a Markdown file."""
    SENTENCES_FILE.write_text(sentences_text(), encoding="utf-8")
    text = readme.read_text(encoding="utf-8")
    pattern = re.compile(re.escape(_BEGIN) + ".*?" + re.escape(_END), re.DOTALL)
    readme.write_text(pattern.sub(lambda _: _BEGIN + commands_table() + _END, text), encoding="utf-8")


if __name__ == "__main__":
    update(Path(sys.argv[1]))
