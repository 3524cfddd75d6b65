"""Lets go of runs: old ones, the least recently used ones of too many, and what killed processes left."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from irsim.runs.files import TEMPORARY
from irsim.runs.store import ABANDONED, ID, META, being_written, date_of, dated_folders

__all__ = ["DAY", "QUOTA", "prune", "remove", "tidy"]

QUOTA = 500 * 1000 * 1000
"""Bytes that the runs of a workspace may take together; the least recently used ones make room."""
DAY = 24 * 3600.0
"""Seconds after its last use that a run is kept."""
_TRASH = ".gone-"
_TIDIED = ".tidied"
_BETWEEN_TIDYING = 5.0
"""Seconds: looking at every run before each short one would cost more than the run."""


def prune(runs: Path, *, quota: int = QUOTA, age: float = DAY, keep: str | None = None) -> list[str]:
    """Let go of runs that nobody has used for ``age`` seconds, and of the least recently used ones beyond the quota.

    Runs that are being written stay, and so does ``keep``. Leftovers of processes that were killed are swept up.

    Args:
        runs: Folder of all runs.
        quota: Bytes they may take together.
        age: Seconds after its last use.
        keep: Id of a run that stays.

    Returns:
        Ids of what was let go.
    """
    _sweep(runs)
    runs_used = dated_folders(runs, (META,))[::-1]  # the latest used last
    sizes = {folder: _size_of(folder) for _, folder in runs_used}
    total, gone, oldest = sum(size for size, _ in sizes.values()), list[str](), time.time_ns() - age * 1e9
    for used, folder in runs_used:
        size, leftovers = sizes[folder]
        unwanted = used < oldest or total > quota
        if not (unwanted or leftovers) or folder.name == keep or being_written(folder):
            continue
        if unwanted:
            remove(folder)
            gone.append(folder.name)
            total -= size
        else:
            _sweep_run(leftovers)
    return gone


def tidy(runs: str | Path) -> None:
    """:func:`prune`, unless somebody did so a moment ago."""
    mark = f"{runs}{os.sep}{_TIDIED}"
    with suppress(OSError):
        if 0 <= time.time() - os.stat(mark).st_mtime < _BETWEEN_TIDYING:
            return
    with suppress(OSError):
        Path(mark).touch()
    prune(Path(runs))


def _size_of(folder: Path) -> tuple[int, list[str]]:
    """Bytes of a run, and its temporary files."""
    total, leftovers = 0, list[str]()
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            with suppress(OSError):
                total += entry.stat(follow_symlinks=False).st_size
            if entry.name.startswith(TEMPORARY):
                leftovers.append(entry.path)
    return total, leftovers


def remove(folder: Path) -> None:
    """First out of sight as a whole, then bit by bit."""
    trash = folder.with_name(f"{_TRASH}{folder.name}-{os.urandom(3).hex()}")
    with suppress(OSError):
        os.rename(folder, trash)
        shutil.rmtree(trash, ignore_errors=True)


def _sweep(runs: Path) -> None:
    """Remove what a killed process left: half-removed runs, and folders that never became a run."""
    for folder in _children(runs):
        if folder.name.startswith(_TRASH):
            shutil.rmtree(folder, ignore_errors=True)
        elif ID.fullmatch(folder.name) and date_of(os.path.join(folder, META)) is None:
            with suppress(OSError):
                young = time.time() - folder.stat().st_mtime < ABANDONED
                if not young and not being_written(folder):
                    remove(folder)


def _sweep_run(leftovers: list[str]) -> None:
    """Remove temporary files that a killed process left in a run."""
    for path in leftovers:
        with suppress(OSError):
            if time.time() - os.lstat(path).st_mtime > ABANDONED:
                os.unlink(path)


def _children(runs: Path) -> Iterator[Path]:
    with suppress(OSError), os.scandir(runs) as entries:
        yield from [Path(entry.path) for entry in entries if entry.is_dir(follow_symlinks=False)]
