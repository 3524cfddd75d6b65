"""The files of the studio: scenarios below one folder, which it lists, reads and writes, and nothing else."""

from __future__ import annotations

import os
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

from irsim.common.files import replace_bytes, write_new
from irsim.common.hashing import digest
from irsim.common.records import FileError, read_bytes
from irsim.scenario.locate import why_outside

__all__ = ["FileChanged", "FileRefused", "Workspace"]

_ENDINGS = (".yaml", ".yml")
_MOST_LISTED = 500
"""Number of files that are offered."""
_MOST_LOOKED = 20_000
"""Number of entries of folders that are looked at for them."""
_MOST_BYTES = 1_000_000
"""Size of the largest file that is read or written [bytes]."""


class FileRefused(ValueError):
    """A file that may not be read or written; the message says why."""


class FileChanged(FileRefused):
    """A file that another program has changed since it was read.

    Args:
        text: Its text now.
    """

    def __init__(self, text: str) -> None:
        super().__init__("another program has changed this file since it was opened")
        self.text = text


class Workspace:
    """The folder of the studio.

    Args:
        root: The folder; links in its path are resolved once, here.
    """

    def __init__(self, root: Path) -> None:
        self.root = root.resolve()

    def names(self) -> list[str]:
        """Paths of its scenario files, with ``/``, those in folders of folders last."""
        return sorted(islice(self._found(), _MOST_LISTED), key=lambda name: (name.count("/"), name))

    def read(self, name: str) -> tuple[str, str]:
        """The text of a file, and a mark of it by which a later change is noticed.

        Raises:
            FileRefused: This folder has no such scenario, or it cannot be read.
        """
        data = self._bytes(self._target(name))
        if data is None:
            raise FileRefused(f"there is no file '{name}' in {self.root}")
        try:
            return data.decode(), digest(data)
        except UnicodeDecodeError:
            raise FileRefused(f"'{name}' is not UTF-8 text") from None

    def write(self, name: str, text: str, mark: str | None) -> str:
        """Write a file in one step and return its new mark.

        Args:
            name: The file.
            text: Its text.
            mark: Mark of the text that was read; None: the file is new.

        Raises:
            FileChanged: The file has another text by now, or exists although it should be new.
            FileRefused: It may not or cannot be written.
        """
        target, data = self._target(name), text.encode()
        if len(data) > _MOST_BYTES:
            raise FileRefused(f"a scenario may have {_MOST_BYTES:,} bytes")
        there = self._bytes(target)
        if there is not None and (mark is None or digest(there) != mark):
            raise FileChanged(there.decode(errors="replace"))
        try:
            if there is None:
                write_new(target, text)
            else:
                replace_bytes(target, data, mode=target.stat().st_mode & 0o777)
        except (OSError, ValueError) as error:
            raise FileRefused(f"'{name}' cannot be written: {error}") from None
        return digest(data)

    def path_of(self, name: str) -> str:
        """The path of a file, which may not exist yet.

        Raises:
            FileRefused: It leads out of the folder, or does not end as scenarios do.
        """
        return str(self._target(name))

    def _target(self, name: str) -> Path:
        wrong = why_outside(name, self.root)
        if wrong is not None:
            raise FileRefused(f"'{name}' {wrong}: the studio reads and writes only files in {self.root}")
        if not name.lower().endswith(_ENDINGS):
            raise FileRefused(f"'{name}': the name of a scenario file ends with .yaml")
        if any(part.startswith(".") for part in Path(name).parts):
            raise FileRefused(f"'{name}' is hidden")
        return self.root / name

    def _bytes(self, target: Path) -> bytes | None:
        if not target.exists():
            return None
        try:
            return read_bytes(target, _MOST_BYTES)
        except FileError as error:
            raise FileRefused(f"'{target.name}' cannot be read: {error}") from None

    def _found(self) -> Iterator[str]:
        left, folders = _MOST_LOOKED, [self.root]
        while folders and left > 0:
            here = folders.pop(0)
            try:
                entries = list(islice(os.scandir(here), left))
            except OSError:
                continue
            left -= len(entries)
            for entry in sorted(entries, key=lambda one: one.name):
                if entry.name.startswith(".") or entry.is_symlink():
                    continue
                if entry.is_dir():
                    if len(Path(entry.path).relative_to(self.root).parts) <= 2:
                        folders.append(Path(entry.path))
                elif entry.name.lower().endswith(_ENDINGS):
                    yield Path(entry.path).relative_to(self.root).as_posix()
