"""Files that a scenario names: where images are looked for, and the rule that keeps names inside a folder."""

from __future__ import annotations

import re
import stat
import sys
import unicodedata
from collections.abc import Iterable
from pathlib import Path

__all__ = ["BUNDLED", "image_places", "why_outside"]

_INVISIBLE = ("Cc", "Cf", "Cs", "Zl", "Zp")
"""Unicode categories: control characters, text-direction marks, lone surrogates, line and paragraph separators."""
_DRIVE = re.compile(r"[A-Za-z]:")
_WINDOWS_DEVICE = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)


def why_outside(name: str, root: Path, bases: Iterable[Path] = ()) -> str | None:
    """The reason why a file name is not allowed in a program confined to ``root``.

    A name is allowed if it is relative and leads downwards, no link on its way leads out of ``root``, and its target,
    if it exists, is an ordinary file or folder.

    Args:
        name: The name as written.
        root: The folder that the target must lie in.
        bases: Further folders, inside ``root``, that the name may be relative to.

    Returns:
        The problem, worded to follow the name: ``"leads upwards ('..')"``; None if the name is allowed.
    """
    if any(unicodedata.category(character) in _INVISIBLE for character in name):
        return "contains a control character"
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
                return "is a link that leads out of the workspace"
            # since Python 3.13 resolve() leaves cyclic links as they are
            if any(part.is_symlink() for part in (target, *target.parents)):
                return "cannot be followed"
            if target.exists() and not _is_ordinary(target):
                return "is a device or pipe"
    except (OSError, RuntimeError, ValueError):  # cyclic links, a name that is too long, …
        return "cannot be followed"
    return None


def _is_ordinary(target: Path) -> bool:
    mode = target.stat().st_mode
    return stat.S_ISREG(mode) or stat.S_ISDIR(mode)


IMAGES = Path(__file__).parents[1] / "graphics" / "images"
"""Folder of the bundled images."""
BUNDLED = ("car_green.png", "car_blue.png", "car_red.png", "diff_robot0.png", "diff_robot1.png")
"""Names of the bundled images, which show a robot from above, facing right."""


def image_places(name: str, folder: str | Path | None) -> list[Path]:
    """Candidates for an image file: as given, beside the script, beside the scenario (``folder``), bundled."""
    return [place / name for place in (Path(), Path(sys.path[0] or "."), *([Path(folder)] if folder else []), IMAGES)]
