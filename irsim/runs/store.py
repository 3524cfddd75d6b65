"""Folders of runs: their names, dates, status and omissions, and the deletion of old ones.

Uses the standard library only, no NumPy.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import stat
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal

from irsim.common.files import TEMPORARY
from irsim.common.text import clean
from irsim.runs.clock import clock_was_set, date_now
from irsim.runs.files import RunError, json_of, lock_file, plain_file, refusal, replace_file

__all__ = [
    "ARTIFACTS",
    "DAY",
    "FILES",
    "ID",
    "LOCK",
    "META",
    "RESULT",
    "SCENARIO_FILE",
    "Status",
    "find_run",
    "is_run",
    "make_run_folder",
    "mark_cancelled",
    "mark_used",
    "omission_notes",
    "prune",
    "recent_ids",
    "remove",
    "run_folders",
    "runs_folder",
    "runs_path",
    "status_of",
    "tidy",
]

Status = Literal["running", "finished", "cancelled", "interrupted"]
META = "run.json"
"""Metadata of a run; its modification time is the last use of the run."""
RESULT = "result.json"
LOCK = "lock"
"""File of a job that is locked while the job runs."""
SCENARIO_FILE = "scenario.yaml"
"""Scenario of a run, written once when the run starts, and locked while the run is written."""
FILES = (SCENARIO_FILE, "resolved.json", META, RESULT)
"""Files of every complete run; trace and events are in numbered pieces beside them."""
ARTIFACTS = (*FILES, "events.json", "trace.json", "trace.csv", "replay.json")
"""Everything of a run that can be read as text: its files, and what is made of its pieces."""
_EXPIRY = "runs are deleted 24 h after their last use: the same scenario and seed give the same run again"
_WORKSPACE_FOLDER = ".irsim"
_MAX_STEM_LENGTH = 24
"""Number of characters of a scenario's name in the id of a run."""
ID = re.compile(r"[a-z0-9][a-z0-9-]{0,40}-[0-9a-f]{6}")
_LAST = re.compile(r"last(?:-([0-9]{1,6}))?")
_NO_SLUG = re.compile(r"[^a-z0-9]+")
_MAX_NAMED = 5
"""Number of recent runs that a message names."""
ABANDONED = 60.0
"""Time [s] without a write after which a run counts as abandoned, on systems that cannot lock files."""


def runs_folder(workspace: str | Path | None = None, *, make: bool = False) -> Path:
    """The folder of all runs of a workspace, by default of the current directory.

    Args:
        workspace: Folder that contains ``.irsim/runs``.
        make: Create the folder, with a ``.gitignore`` that keeps it out of version control.

    Raises:
        RunError: ``.irsim`` or ``runs`` is a link or not a folder: nothing is read or written through links.
    """
    return Path(runs_path(workspace, make=make))


def runs_path(workspace: str | Path | None = None, *, make: bool = False) -> str:
    """:func:`runs_folder` as text, because a path object takes longer than a few steps of a small world."""
    top = os.path.join(os.getcwd() if workspace is None else workspace, _WORKSPACE_FOLDER)
    folder = f"{top}{os.sep}runs"
    for part in (top, folder):
        mode = _mode(part)
        if mode is not None and not stat.S_ISDIR(mode):
            raise RunError(
                "path-outside-workspace",
                f"'{part}' must be a folder, got a link or another kind of file",
                "put a plain folder there",
            )
    if make:
        ignore = f"{top}{os.sep}.gitignore"
        try:
            if mode is None:
                os.makedirs(folder, exist_ok=True)
        except OSError as error:
            raise refusal(folder, error) from None
        if _mode(ignore) is None:
            replace_file(ignore, b"*\n")
    return folder


def _mode(path: str) -> int | None:
    """File mode of a path, None if it does not exist."""
    try:
        return os.lstat(path).st_mode
    except OSError:
        return None


def make_run_folder(runs: str | Path, stem: str) -> str:
    """Create a folder for a run: ``<stem as a slug>-<six hexadecimal digits>``."""
    slug = _NO_SLUG.sub("-", stem.lower())[:_MAX_STEM_LENGTH].strip("-") or "scenario"
    while True:
        folder = f"{runs}{os.sep}{slug}-{os.urandom(3).hex()}"
        try:
            os.mkdir(folder)
        except FileExistsError:
            continue
        except OSError as error:
            raise refusal(folder, error) from None
        return folder


def run_folders(runs: Path) -> list[Path]:
    """The folders of runs, the one started last first."""
    return [folder for _, folder in dated_folders(runs, (SCENARIO_FILE, META))]


def dated_folders(runs: Path, dated_by: Sequence[str]) -> list[tuple[int, Path]]:
    """Date [ns] and folder of each run, the latest first.

    Args:
        runs: Folder of all runs.
        dated_by: Names of files; the first one that exists gives the date of a run.
    """
    folders: list[tuple[int, str, Path]] = []
    with suppress(FileNotFoundError, NotADirectoryError), os.scandir(runs) as entries:
        for entry in entries:
            if ID.fullmatch(entry.name) and entry.is_dir(follow_symlinks=False):
                with suppress(OSError):  # another process may delete the run at this moment
                    dates = {name: date_of(os.path.join(entry.path, name)) for name in (META, *dated_by)}
                    date = next((dates[name] for name in dated_by if dates[name] is not None), None)
                    if date is not None and dates[META] is not None:
                        folders.append((date, entry.name, Path(entry.path)))
    return [(date, folder) for date, _, folder in sorted(folders, reverse=True)]


def date_of(path: str) -> int | None:
    """Time [ns] at which an ordinary file was written; None if there is no such file."""
    try:
        known = os.lstat(path)
    except OSError:
        return None
    return known.st_mtime_ns if stat.S_ISREG(known.st_mode) else None


def recent_ids(runs: Path, most: int = _MAX_NAMED) -> list[str]:
    """Ids of the runs started last."""
    return [folder.name for folder in run_folders(runs)[:most]]


def find_run(name: str | Path, workspace: str | Path | None = None) -> Path:
    """Find the folder of a run.

    Args:
        name: Id of the run, ``last`` for the run started last, ``last-1`` for the one before, or (only without a
            workspace) its folder.
        workspace: Folder whose ``.irsim/runs`` holds the run; default: the current directory.

    Raises:
        RunError: There is no such run; the message names recent ones.
    """
    if workspace is None and (Path(name) / META).is_file():
        return Path(name)
    runs = runs_folder(workspace)
    if back := _LAST.fullmatch(str(name)):
        folders, before = run_folders(runs), int(back[1] or 0)
        if before < len(folders):
            return folders[before]
    folder = runs / str(name)
    if ID.fullmatch(str(name)) and not folder.is_symlink() and plain_file(folder, META) is not None:
        mark_used(folder)
        return folder
    recent = recent_ids(runs)
    fix = f"recent ones are {', '.join(recent)}" if recent else "there are no runs here"
    how = "; `irsim run FILE --record` records one" if not recent and workspace is None else ""
    raise RunError("unknown-run", f"there is no run {clean(name)!r}", f"{fix}; {_EXPIRY}{how}")


def is_run(name: str | Path) -> bool:
    """Whether a name names a run here: ``last``, ``last-1``, an id, or a folder; the name of a file is not."""
    if _LAST.fullmatch(str(name)) or (Path(name) / META).is_file():
        return not Path(name).is_file()
    return bool(ID.fullmatch(str(name))) and (runs_folder() / str(name) / META).is_file()


def mark_used(folder: str | Path) -> None:
    """Record that a run is used now, which postpones its deletion."""
    with suppress(OSError):
        os.utime(f"{folder}{os.sep}{META}")


def status_of(folder: Path) -> Status:
    """Status of a run; a run without a result that no process writes was interrupted."""
    if plain_file(folder, RESULT) is not None:
        return "finished"
    meta = json_of(folder, META)
    if isinstance(meta, dict) and meta.get("cancelled") is True:
        return "cancelled"
    if being_written(folder):
        return "running"
    return "finished" if plain_file(folder, RESULT) is not None else "interrupted"


def mark_cancelled(folder: Path) -> None:
    """Record that a run was stopped on purpose; a run that has finished stays finished."""
    meta = json_of(folder, META)
    if not isinstance(meta, dict) or plain_file(folder, RESULT) is not None:
        return
    replace_file(folder / META, json.dumps({**meta, "cancelled": True}, indent=1).encode())


def being_written(folder: Path) -> bool:
    """Whether a running process writes a run or a job."""
    path = plain_file(folder, SCENARIO_FILE) or plain_file(folder, LOCK)
    if path is None:
        return False
    try:
        descriptor = os.open(path, os.O_RDWR)
    except OSError:
        return False
    try:
        free = lock_file(descriptor, wait=False)
    finally:
        os.close(descriptor)
    if free is None:
        return time.time() - max(entry.stat().st_mtime for entry in (path, folder)) < ABANDONED
    return not free


def omission_notes(meta: Mapping[str, Any], steps: int | None = None) -> list[str]:
    """Notes on what was too large to be recorded; empty if everything was recorded.

    Args:
        meta: Content of ``run.json``.
        steps: Number of executed steps, None if the run has not ended.
    """
    whole = f"of {steps}" if steps is not None else f"of at most {meta.get('horizon')}"
    until, scans = meta.get("trace_until"), meta.get("scans_until")
    notes = []
    if until is not None and until != steps:
        notes.append(f"recorded until step {until} {whole}: size limit")
    if meta.get("scans") is False:
        notes.append("scans not recorded (too large)")
    elif scans is not None and scans not in (steps, until):
        notes.append(f"scans recorded until step {scans} {whole} (too large)")
    return notes


QUOTA = 500 * 1000 * 1000
"""Size in bytes of all runs of a workspace, beyond which the least recently used ones are deleted."""
DAY = 24 * 3600.0
"""Time [s] after its last use for which a run is kept."""
_TRASH = ".gone-"
"""Prefix of the names of folders that are being deleted."""
_CLOCK = ".clock"
"""File that tells whether the clock was set since the last deletion."""
_TIDIED = ".tidied"
"""File whose modification time is the time of the last tidying."""
_TIDYING_PERIOD_S = 5.0
"""Time [s] between two tidyings: checking all runs before each short run would take longer than the run."""


def prune(runs: Path, *, quota: int = QUOTA, age: float = DAY, keep: str | None = None) -> list[str]:
    """Delete runs that have not been used for ``age`` seconds, and the least recently used ones beyond the quota.

    Runs that are being written stay, and so does ``keep``. Leftovers of killed processes are deleted. Where the clock
    was set, ages say nothing: all runs count as used now, and so do runs from the future.

    Args:
        runs: Folder of all runs.
        quota: Size in bytes that all runs may have together.
        age: Time [s] after its last use for which a run is kept.
        keep: Id of a run that stays.

    Returns:
        Ids of the deleted runs.
    """
    was_set = runs.is_dir() and clock_was_set(runs / _CLOCK)
    for name in (META, SCENARIO_FILE):  # when a run was used last, and when it began
        date_now([folder / name for _, folder in dated_folders(runs, (name,))], was_set)
    if not was_set:
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
