"""Which folders have changed while somebody works in them."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

__all__ = ["Changes", "fingerprint"]

Fingerprint = tuple[tuple[str, int, int], ...]
"""Path, time of the last change [ns] and size [bytes] of each file."""


def fingerprint(folder: Path) -> Fingerprint:
    """What tells two states of a folder apart. Hidden files are left out; files that vanish meanwhile are, too."""
    found = []
    for parent, folders, names in os.walk(folder):
        folders[:] = [name for name in folders if not name.startswith(".") and name != "__pycache__"]
        for name in names:
            path = os.path.join(parent, name)
            try:
                state = os.lstat(path)
            except OSError:
                continue
            if not name.startswith("."):
                found.append((path, state.st_mtime_ns, state.st_size))
    return tuple(sorted(found))


class Changes:
    """Finds folders whose files have changed and then stayed the same from one look to the next.

    A file that is still being written is left alone until nothing has happened to it between two looks.

    Args:
        folders: Folders whose present state is known already.
    """

    def __init__(self, folders: Iterable[Path]) -> None:
        self._known = {folder: fingerprint(folder) for folder in folders}
        self._last = dict(self._known)

    def look(self, folders: Iterable[Path]) -> list[Path]:
        """The folders to grade again, new ones included."""
        now = {folder: fingerprint(folder) for folder in folders}
        ready = [
            folder
            for folder, state in now.items()
            if state != self._known.get(folder) and state == self._last.get(folder)
        ]
        self._known.update((folder, now[folder]) for folder in ready)
        self._last = now
        return ready
