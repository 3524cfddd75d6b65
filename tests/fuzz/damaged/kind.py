"""A kind of file, and functions that write and read examples of several kinds."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from irsim.bridges.maps.importing import import_map
from irsim.bridges.maps.source import ImportLimits

__all__ = ["IMPORT", "Kind", "Make", "made", "read_map_of", "text"]

Make = Callable[[Path], Path]
Read = Callable[[Path, random.Random], object]
IMPORT = ImportLimits(triangles=100_000, cells=250_000)


@dataclass(frozen=True)
class Kind:
    """A kind of file.

    Attributes:
        make: Writes an example into an empty folder and returns its file.
        read: Reads the file.
        share: One way in ``share`` is tried, for kinds whose reading takes long.
    """

    make: Make
    read: Read
    share: int = 1


def text(name: str, content: str, **others: str) -> Make:
    """Writes a file, and others beside it."""

    def make(folder: Path) -> Path:
        for file, one in {**others, name: content}.items():
            (folder / file).write_text(one, encoding="utf-8")
        return folder / name

    return make


def made(write: Callable[[Path], object], name: str) -> Make:
    """Writes a file with a function."""

    def make(folder: Path) -> Path:
        write(folder / name)
        return folder / name

    return make


def read_map_of(file: Path, draw: random.Random) -> None:
    """Import a map of the file."""
    import_map(file, file.with_name("scene.yaml"), limits=IMPORT, overwrite=True, resolution=0.2)
