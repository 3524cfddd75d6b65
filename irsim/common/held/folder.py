"""A folder with a descriptor, from which paths below it are walked component by component."""

from __future__ import annotations

import builtins
import errno
import os
import sys
import weakref
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import SimpleNamespace
from typing import Any

__all__ = ["AVAILABLE", "BELOW", "PAIRS", "REAL", "Folder"]

BELOW = ("open", "stat", "access", "utime", "mkdir", "rmdir", "unlink", "remove", "readlink")
"""Functions of ``os`` with a path and ``dir_fd``."""
PAIRS = ("rename", "replace", "link")
"""Functions of ``os`` with two paths, each with a descriptor of its own."""
_OTHERS = ("lstat", "chmod", "scandir", "listdir", "getcwd")
AVAILABLE = {os.open, os.stat, os.mkdir, os.unlink, os.rename, os.link, os.readlink, os.utime} <= os.supports_dir_fd
"""Whether the system has what holding a folder needs."""
REAL = SimpleNamespace(**{name: getattr(os, name) for name in (*BELOW, *PAIRS, *_OTHERS)}, file=builtins.open)
"""The functions of the system."""
_FOLDER = os.O_RDONLY | getattr(os, "O_DIRECTORY", 0) | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_PATH", 0)
_MAX_PATH_BYTES = 4096
"""Length of a path that no system opens."""
_MAX_LINKS = 40
"""Number of links on the way to one file."""


class Folder:
    """A folder that is opened once.

    Args:
        path: Its path without links.
        descriptor: A descriptor of it, which a parent process has passed on; default: a new one.

    Raises:
        OSError: There is no such folder.
    """

    def __init__(self, path: str | os.PathLike[str], descriptor: int | None = None) -> None:
        self.path = os.path.normpath(os.fspath(path))
        opened = REAL.open(self.path, _FOLDER) if descriptor is None else descriptor
        self.descriptor: int = opened
        weakref.finalize(self, os.close, opened).atexit = False
        self._libraries: dict[str, str] = {}
        """Python's own folders below this one, which may be links: where they are when this process starts."""
        for place in map(os.path.abspath, (sys.prefix, sys.base_prefix, *sys.path)):
            if self._within(place) not in (None, ".") and os.path.realpath(place) != place:
                self._libraries[place] = os.path.realpath(place)

    def below(self, path: Any) -> str | None:
        """A path relative to the folder; None for what is elsewhere, and for descriptors.

        Raises:
            PermissionError: A relative path leads upwards out of the folder.
        """
        if isinstance(path, int):
            return None
        text = os.fsdecode(path)
        if "\0" in text or not text:
            return None  # the system refuses it
        if len(os.fsencode(text)) >= _MAX_PATH_BYTES:
            raise OSError(errno.ENAMETOOLONG, os.strerror(errno.ENAMETOOLONG), text)
        if not os.path.isabs(text):
            inside = self._within(os.path.join(self.path, text))
            if inside is None:
                raise PermissionError(errno.EPERM, "it is outside of the workspace", text)
            return inside
        return self._within(text)

    def _within(self, path: str) -> str | None:
        text = os.path.normpath(path)
        for place, real in self._libraries.items():
            if text.startswith(place + os.sep):
                text = real + text[len(place) :]
        text, above = os.sep + text.lstrip(os.sep), self.path.rstrip(os.sep) + os.sep
        if text == self.path:
            return "."
        return text[len(above) :] if text.startswith(above) else None

    @contextmanager
    def at(self, inside: str, follow: bool) -> Iterator[tuple[int, str]]:
        """The descriptor of the folder that holds a file, and the name of the file in it, which is not a link.

        Args:
            inside: Path relative to this folder.
            follow: Whether a link at the end is followed; one that is not may be the file.

        Raises:
            OSError: A folder on the way does not exist, or a link leads out.
        """
        for _ in range(_MAX_LINKS):
            folder, name, target = self._walk(inside, follow)
            if folder is not None:
                try:
                    yield folder, name
                finally:
                    os.close(folder)
                return
            inside = self.inner(target)
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), inside)

    def inner(self, target: str) -> str:
        """The target of a link, relative to this folder.

        Raises:
            FileNotFoundError: The link leads out.
        """
        inside = self._within(os.path.join(self.path, target))
        if inside is None:
            raise FileNotFoundError(errno.ENOENT, "a link leads out of the workspace", target)
        return inside

    def _walk(self, inside: str, follow: bool) -> tuple[int | None, str, str]:
        """Descriptor of the last folder and a name; None and where a link leads if there is one on the way."""
        *folders, name = inside.split(os.sep)
        folder = REAL.open(".", _FOLDER, dir_fd=self.descriptor)
        try:
            for done, part in enumerate(folders):
                try:
                    inner = REAL.open(part, _FOLDER, dir_fd=folder)
                except OSError:
                    target = _link(part, folder)
                    if target is None:
                        raise
                    os.close(folder)
                    return None, "", os.path.join(*folders[:done], target, *folders[done + 1 :], name)
                os.close(folder)
                folder = inner
            target = _link(name, folder) if follow else None
        except OSError:
            os.close(folder)
            raise
        if target is None:
            return folder, name, ""
        os.close(folder)
        return None, "", os.path.join(*folders, target)


def _link(name: str, folder: int) -> str | None:
    """Where a link leads; None if the name is not a link."""
    with suppress(OSError):
        return str(REAL.readlink(name, dir_fd=folder))
    return None
