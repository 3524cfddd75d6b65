"""Keeping file names inside a folder: the one rule for scenario files and for files that scenarios name."""

from __future__ import annotations

import re
import stat
import unicodedata
from collections.abc import Iterable
from pathlib import Path

__all__ = ["why_outside"]

_INVISIBLE = ("Cc", "Cf", "Cs", "Zl", "Zp")
"""Unicode categories: controls, marks that turn text around, halves of characters, line and paragraph separators."""
_DRIVE = re.compile(r"[A-Za-z]:")
_WINDOWS_DEVICE = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)


def why_outside(name: str, root: Path, bases: Iterable[Path] = ()) -> str | None:
    """Why a file name may not be used by someone confined to ``root``.

    Only relative names that lead downwards pass, and only if no link on the way leads out and what they lead to, where
    it exists, is an ordinary file or folder.

    Args:
        name: As somebody wrote it.
        root: The folder to stay in.
        bases: Further folders, inside ``root``, that the name may be relative to.

    Returns:
        What is wrong, to be put behind the name: ``"leads upwards ('..')"``; None if the name is fine.
    """
    if any(unicodedata.category(character) in _INVISIBLE for character in name):
        return "holds a control character"
    words = re.split(r"[/\\]", name)
    if name.startswith(("/", "\\")) or _DRIVE.match(name):
        return "is an absolute path"
    if name.startswith("~"):
        return "starts in a home folder"
    if ".." in words:
        return "leads upwards ('..')"
    if any(_WINDOWS_DEVICE.fullmatch(word.rstrip(" .")) for word in words):
        return "is the name of a device"
    try:
        limit = root.resolve()
        for base in (limit, *(limit / base for base in bases)):
            target = (base / name).resolve()
            if not target.is_relative_to(limit):
                return "is a link that leads out of it"
            if any(part.is_symlink() for part in (target, *target.parents)):  # from 3.13 on a ring is left as it is
                return "cannot be followed"
            if target.exists() and not _ordinary(target):
                return "is a device or pipe"
    except (OSError, RuntimeError, ValueError):  # a ring of links, a name too long, …
        return "cannot be followed"
    return None


def _ordinary(target: Path) -> bool:
    mode = target.stat().st_mode
    return stat.S_ISREG(mode) or stat.S_ISDIR(mode)
