"""The entries of a folder, in the form of ``os.scandir``."""

from __future__ import annotations

import os
import stat
from collections.abc import Callable, Iterator

__all__ = ["Entries", "Entry"]


class Entry:
    """An entry of a folder, as of ``os.scandir``."""

    def __init__(self, path: str, name: str, known: os.stat_result) -> None:
        self.name, self._known = name, known
        self.path = os.path.join(path, name)

    def __fspath__(self) -> str:
        return self.path

    def stat(self, *, follow_symlinks: bool = True) -> os.stat_result:
        """Its status; of a link that is followed, the status of where it leads."""
        return os.stat(self.path) if follow_symlinks and self.is_symlink() else self._known

    def inode(self) -> int:
        """Its number on the disk."""
        return self._known.st_ino

    def is_symlink(self) -> bool:
        """Whether it is a link."""
        return stat.S_ISLNK(self._known.st_mode)

    def is_junction(self) -> bool:
        """Whether it is a junction of Windows."""
        return False

    def is_dir(self, *, follow_symlinks: bool = True) -> bool:
        """Whether it is a folder."""
        return self._is(stat.S_ISDIR, follow_symlinks)

    def is_file(self, *, follow_symlinks: bool = True) -> bool:
        """Whether it is an ordinary file."""
        return self._is(stat.S_ISREG, follow_symlinks)

    def _is(self, kind: Callable[[int], bool], follow: bool) -> bool:
        try:
            return kind(self.stat(follow_symlinks=follow).st_mode)
        except OSError:
            return False


class Entries:
    """The entries of a folder, as ``os.scandir`` returns them."""

    def __init__(self, entries: list[Entry]) -> None:
        self._entries = iter(entries)

    def __iter__(self) -> Iterator[Entry]:
        return self._entries

    def __next__(self) -> Entry:
        return next(self._entries)

    def __enter__(self) -> Entries:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the listing."""
        self._entries = iter(())
