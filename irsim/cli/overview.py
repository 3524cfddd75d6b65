"""Makes the table of commands in the README: ``python -m irsim.cli.overview README.md`` updates it."""

from __future__ import annotations

import inspect
import re
import sys
from pathlib import Path

from irsim.cli.app import app

__all__ = ["commands_table", "update"]

_BEGIN, _END = "<!-- begin commands -->\n", "<!-- end commands -->"


def commands_table() -> str:
    """Return a Markdown table with one row per command: its name and the first paragraph of its help."""
    rows = ["| command | what it does |", "|---|---|"]
    groups = [
        ("irsim", app),
        *(
            (f"irsim {group.typer_instance.info.name}", group.typer_instance)
            for group in app.registered_groups
            if group.typer_instance is not None
        ),
    ]
    for program, commands in groups:
        assert commands is not None
        for command in commands.registered_commands:
            assert command.callback is not None
            first = inspect.cleandoc(command.callback.__doc__ or "").partition("\n\n")[0].replace("\n", " ")
            rows.append(f"| `{program} {command.name or command.callback.__name__}` | {first} |")
    return "\n".join(rows) + "\n"


def update(file: Path) -> None:
    """Replace the table between the markers of a Markdown file."""
    text = file.read_text(encoding="utf-8")
    pattern = re.compile(re.escape(_BEGIN) + ".*?" + re.escape(_END), re.DOTALL)
    file.write_text(pattern.sub(lambda _: _BEGIN + commands_table() + _END, text), encoding="utf-8")


if __name__ == "__main__":
    update(Path(sys.argv[1]))
