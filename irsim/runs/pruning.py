"""Deletes old runs, the least recently used runs beyond a quota, and what killed processes left."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from irsim.common.files import TEMPORARY
from irsim.runs.store import ABANDONED, ID, META, being_written, date_of, dated_folders

__all__ = ["DAY", "QUOTA", "prune", "remove", "tidy"]

QUOTA = 500 * 1000 * 1000
"""Size in bytes of all runs of a workspace, beyond which the least recently used ones are deleted."""
DAY = 24 * 3600.0
"""Time [s] after its last use for which a run is kept."""
_TRASH = ".gone-"
"""Prefix of the names of folders that are being deleted."""
_TIDIED = ".tidied"
"""File whose modification time is the time of the last tidying."""
_TIDYING_PERIOD_S = 5.0
"""Time [s] between two tidyings: checking all runs before each short run would take longer than the run."""


def prune(runs: Path, *, quota: int = QUOTA, age: float = DAY, keep: str | None = None) -> list[str]:
    """Delete runs that have not been used for ``age`` seconds, and the least recently used ones beyond the quota.

    Runs that are being written stay, and so does ``keep``. Leftovers of killed processes are deleted.

    Args:
        runs: Folder of all runs.
        quota: Size in bytes that all runs may have together.
        age: Time [s] after its last use for which a run is kept.
        keep: Id of a run that stays.

    Returns:
        Ids of the deleted runs.
    """
    _sweep(runs)
    runs_used = dated_folders(runs, (META,))[::-1]  # the most recently used one last
    sizes = {folder: _size_of(folder) for _, folder in runs_used}
    total, deleted, oldest = sum(size for size, _ in sizes.values()), list[str](), time.time_ns() - age * 1e9
    for used, folder in runs_used:
        size, leftovers = sizes[folder]
        unwanted = used < oldest or total > quota
        if not (unwanted or leftovers) or folder.name == keep or being_written(folder):
            continue
        if unwanted:
            remove(folder)
            deleted.append(folder.name)
            total -= size
        else:
            _sweep_run(leftovers)
    return deleted


def tidy(runs: str | Path) -> None:
    """:func:`prune`, unless the runs were pruned a moment ago."""
    mark = f"{runs}{os.sep}{_TIDIED}"
    with suppress(OSError):
        if 0 <= time.time() - os.stat(mark).st_mtime < _TIDYING_PERIOD_S:
            return
    with suppress(OSError):
        Path(mark).touch()
    prune(Path(runs))


def _size_of(folder: Path) -> tuple[int, list[str]]:
    """Size of a run in bytes, and paths of its temporary files."""
    total, leftovers = 0, list[str]()
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            with suppress(OSError):
                total += entry.stat(follow_symlinks=False).st_size
            if entry.name.startswith(TEMPORARY):
                leftovers.append(entry.path)
    return total, leftovers


def remove(folder: Path) -> None:
    """Delete a run: rename its folder first, so that no reader sees half of it."""
    trash = folder.with_name(f"{_TRASH}{folder.name}-{os.urandom(3).hex()}")
    with suppress(OSError):
        os.rename(folder, trash)
        shutil.rmtree(trash, ignore_errors=True)


def _sweep(runs: Path) -> None:
    """Delete what a killed process left: partly deleted runs, and folders that never became a run."""
    for folder in _children(runs):
        if folder.name.startswith(_TRASH):
            shutil.rmtree(folder, ignore_errors=True)
        elif ID.fullmatch(folder.name) and date_of(os.path.join(folder, META)) is None:
            with suppress(OSError):
                young = time.time() - folder.stat().st_mtime < ABANDONED
                if not young and not being_written(folder):
                    remove(folder)


def _sweep_run(leftovers: list[str]) -> None:
    """Delete temporary files that a killed process left in a run."""
    for path in leftovers:
        with suppress(OSError):
            if time.time() - os.lstat(path).st_mtime > ABANDONED:
                os.unlink(path)


def _children(runs: Path) -> Iterator[Path]:
    with suppress(OSError), os.scandir(runs) as entries:
        yield from [Path(entry.path) for entry in entries if entry.is_dir(follow_symlinks=False)]
