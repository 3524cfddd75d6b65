"""Writes what is known of commands without importing them: ``python -m irsim.cli.overview``.

That is their first sentences, which ``irsim --help`` shows.
"""

from __future__ import annotations

import inspect
import json
from pathlib import Path

import typer

from irsim.cli.app import COMMANDS, loaded

__all__ = ["SENTENCES_FILE", "sentences_text"]

SENTENCES_FILE = Path(__file__).with_name("sentences.py")


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
        '"""First sentences of the commands; ``python -m irsim.cli.overview`` writes this file."""',
        "",
        "SENTENCES = {",
    ]
    return "\n".join([*head, *lines, "}"]) + "\n"


if __name__ == "__main__":
    SENTENCES_FILE.write_text(sentences_text(), encoding="utf-8")
