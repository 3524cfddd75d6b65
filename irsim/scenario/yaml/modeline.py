"""The first line by which editors find the schema: ``# yaml-language-server: $schema=...``."""

from __future__ import annotations

import os
import re
from pathlib import Path

from irsim.common import data_files as resources

__all__ = ["schema_reference", "with_modeline", "without_modeline"]

_MODELINE = re.compile(r"\A\ufeff?#[ \t]*yaml-language-server:[ \t]*\$schema=[^\r\n]*")


def schema_reference(target: Path, *, installed: bool = False) -> str:
    """How a file refers to the schema: relative inside the checkout, else by the published address.

    Args:
        target: The scenario file, which need not exist.
        installed: Name the schema of this installation instead of the published one, for editors without a network.
    """
    schema, folder, root = resources.schema_file().resolve(), target.resolve().parent, resources.checkout()
    if root is not None and folder.is_relative_to(root):
        relative = Path(os.path.relpath(schema, folder)).as_posix()
        if not re.search(r"\s", relative):
            return relative
    return schema.as_uri() if installed else resources.published_schema()


def with_modeline(text: str, target: Path, *, installed: bool = False) -> str:
    """The text with the editor line for ``target`` on top; an earlier editor line is replaced.

    Args:
        text: The scenario.
        target: Its file.
        installed: As for :func:`schema_reference`.
    """
    line = f"# yaml-language-server: $schema={schema_reference(target, installed=installed)}"
    if _MODELINE.match(text):
        return _MODELINE.sub(lambda _: line, text, count=1)
    newline = "\r\n" if "\r\n" in text else "\n"
    return line + newline + text.removeprefix("\ufeff")


def without_modeline(text: str) -> str:
    """The text without the editor line, for readers who cannot use the path of the schema."""
    return _MODELINE.sub("", text, count=1).lstrip("\r\n")
