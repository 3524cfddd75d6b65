"""A place in a folder that is a link to its double outside, and not, in turn: at every opening of a file, or at random.

``python swapping.py PLACE ASIDE DOUBLE`` swaps as fast as it can until its input ends.
"""

from __future__ import annotations

import functools
import os
import posix
import shutil
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

__all__ = ["Double", "Swap", "swap_at_each", "swapping"]


class Swap:
    """Replaces a place by a link to its double, and back.

    Args:
        place: A file or folder.
        aside: Where it is while the link has its place.
        double: Where the link leads.
    """

    def __init__(self, place: Path, aside: Path, double: Path) -> None:
        self.place, self.aside, self.double = str(place), str(aside), str(double)
        self.count, self.linked = 0, False

    def __call__(self) -> None:
        """Swap."""
        self.count += 1
        if self.linked:
            posix.unlink(self.place)  # while a folder is held, os has other functions
            with suppress(FileNotFoundError):  # it did not exist
                posix.rename(self.aside, self.place)
        else:
            with suppress(FileNotFoundError):
                posix.rename(self.place, self.aside)
            posix.symlink(self.double, self.place)
        self.linked = not self.linked

    def restore(self) -> None:
        """Put back what was there, in place of what a program has made meanwhile."""
        if os.path.islink(self.place):
            posix.unlink(self.place)
        if os.path.lexists(self.aside):
            if os.path.isdir(self.place):
                shutil.rmtree(self.place)
            posix.rename(self.aside, self.place)
        self.linked = False


_EVENTS = ("open", "os.listdir", "os.scandir", "os.mkdir", "os.rename", "os.remove", "os.rmdir", "os.utime", "os.link")
_OWN = (sys.prefix, sys.base_prefix, str(Path(__file__).parents[2]), "/proc", "/sys")
"""Where modules are read from, which has nothing to do with the folder."""
_active: Callable[[], None] | None = None
_busy = threading.Lock()


def _hook(event: str, arguments: tuple[Any, ...]) -> None:
    if _active is None or event not in _EVENTS or str(arguments[0]).startswith(_OWN):
        return
    if _busy.acquire(blocking=False):
        try:
            with suppress(OSError):  # the program has made or removed something in its place
                _active()
        finally:
            _busy.release()


@functools.cache
def _listen() -> None:
    sys.addaudithook(_hook)  # it stays until the process ends


def swap_at_each(swap: Callable[[], None]) -> None:
    """Do something before each of these calls until the process ends."""
    global _active
    _listen()
    _active = swap


@contextmanager
def swapping(swap: Swap, *, first: bool = False) -> Iterator[None]:
    """Swap before each call of the system that opens, makes or moves a file, in this process.

    Args:
        swap: The swap to make.
        first: Begin with the link.
    """
    global _active
    _listen()
    if first:
        swap()
    _active = swap
    try:
        yield
    finally:
        _active = None
        swap.restore()


class Double:
    """A copy of a folder beside it, in which a robot has another name: no program may read or write it.

    Args:
        folder: The folder.
        name: A name in its files.
        other: As long a name, which stands in the copy.
    """

    def __init__(self, folder: Path, name: str, other: str) -> None:
        self.folder = folder.with_name(f"{folder.name}-double")
        self.folder.mkdir()
        for path in sorted(folder.rglob("*")):
            copy = self.folder / path.relative_to(folder)
            if path.is_dir():
                copy.mkdir()
            else:
                copy.write_bytes(path.read_bytes().replace(name.encode(), other.encode()))
        self.reset()

    def reset(self) -> None:
        """Date everything, so that what is read or written shows."""
        for path in (self.folder, *self.folder.rglob("*")):
            os.utime(path, (1, 2))
        self._known = self._state()

    def _state(self) -> dict[str, tuple[float, float]]:
        matches = {}
        for folder, folders, files in os.walk(self.folder, topdown=False):
            for path in (os.path.join(folder, name) for name in (*folders, *files)):
                status = os.stat(path)
                matches[path] = (0.0 if os.path.isdir(path) else status.st_atime, status.st_mtime)
        return matches

    def changes(self) -> set[str]:
        """Paths that were read, written, made or removed."""
        now = self._state()
        return {path for path in {*now, *self._known} if now.get(path) != self._known.get(path)}


if __name__ == "__main__":
    race = Swap(*map(Path, sys.argv[1:4]))
    threading.Thread(target=lambda: (sys.stdin.read(), os._exit(0)), daemon=True).start()
    while True:
        with suppress(OSError):
            race()
