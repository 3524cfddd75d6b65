"""Where runs are kept: names, folders, and who is writing. Standard library only, no NumPy."""

from __future__ import annotations

import json
import os
import re
import stat
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Literal

from irsim.common.text import clean
from irsim.runs.files import RunError, json_of, locked, plain_file, refusal, written

__all__ = [
    "ABANDONED",
    "ARTIFACTS",
    "BEGUN",
    "FILES",
    "ID",
    "LOCK",
    "META",
    "RESULT",
    "Status",
    "being_written",
    "date_of",
    "dated_folders",
    "find_run",
    "made_folder",
    "mark_cancelled",
    "recent_ids",
    "run_folders",
    "runs_folder",
    "runs_place",
    "status_of",
    "used",
]

Status = Literal["running", "finished", "cancelled", "interrupted"]
META, RESULT, LOCK = "run.json", "result.json", "lock"
BEGUN = "scenario.yaml"
"""Written once, when a run begins, and locked as long as it is written; ``run.json`` is touched by each use."""
FILES = (BEGUN, "resolved.json", META, RESULT)
"""Of every complete run; trace and events are in numbered pieces beside them."""
ARTIFACTS = (*FILES, "events.json", "trace.json", "trace.csv", "replay.json")
"""What there is of a run as text: files, and what is made of the pieces."""
_AGAIN = "runs are let go 24 h after their last use: the same scenario and seed give the same run again"
_KEPT_IN = ".irsim"
_LONGEST_STEM = 24
ID = re.compile(r"[a-z0-9][a-z0-9-]{0,40}-[0-9a-f]{6}")
_NO_SLUG = re.compile(r"[^a-z0-9]+")
_NAMED = 5
ABANDONED = 60.0
"""Where files cannot be locked: seconds without a sign of life after which nobody writes any more."""


def runs_folder(workspace: str | Path | None = None, *, make: bool = False) -> Path:
    """The folder of all runs of a workspace, by default of the current directory.

    Args:
        workspace: Folder whose ``.irsim/runs`` is meant.
        make: Make it, with a ``.gitignore`` that keeps all of it out of version control.

    Raises:
        RunError: ``.irsim`` or ``runs`` is a link or no folder: nothing is read or written through links.
    """
    return Path(runs_place(workspace, make=make))


def runs_place(workspace: str | Path | None = None, *, make: bool = False) -> str:
    """:func:`runs_folder` as text: a path object would take longer than a few steps of a small world."""
    top = os.path.join(os.getcwd() if workspace is None else workspace, _KEPT_IN)
    folder = f"{top}{os.sep}runs"
    for part in (top, folder):
        mode = _mode(part)
        if mode is not None and not stat.S_ISDIR(mode):
            raise RunError("path-outside-workspace", f"'{part}' is a link or no folder", "put a plain folder there")
    if make:
        ignore = f"{top}{os.sep}.gitignore"
        try:
            if mode is None:
                os.makedirs(folder, exist_ok=True)
        except OSError as error:
            raise refusal(folder, error) from None
        if _mode(ignore) is None:
            written(ignore, b"*\n")
    return folder


def _mode(path: str) -> int | None:
    """What kind of thing is there, None without any."""
    try:
        return os.lstat(path).st_mode
    except OSError:
        return None


def made_folder(runs: str | Path, stem: str) -> str:
    """A new folder for a run: ``<stem as a slug>-<six hexadecimal digits>``."""
    slug = _NO_SLUG.sub("-", stem.lower())[:_LONGEST_STEM].strip("-") or "scenario"
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
    """The folders of runs, the one begun last first."""
    return [folder for _, folder in dated_folders(runs, (BEGUN, META))]


def dated_folders(runs: Path, dated_by: Sequence[str]) -> list[tuple[int, Path]]:
    """Date [ns] and folder of each run, the latest first, by the date of the first of those files that is there."""
    found: list[tuple[int, str, Path]] = []
    with suppress(FileNotFoundError, NotADirectoryError), os.scandir(runs) as entries:
        for entry in entries:
            if ID.fullmatch(entry.name) and entry.is_dir(follow_symlinks=False):
                with suppress(OSError):  # it may be let go at this moment
                    dates = {name: date_of(os.path.join(entry.path, name)) for name in (META, *dated_by)}
                    date = next((dates[name] for name in dated_by if dates[name] is not None), None)
                    if date is not None and dates[META] is not None:
                        found.append((date, entry.name, Path(entry.path)))
    return [(date, folder) for date, _, folder in sorted(found, reverse=True)]


def date_of(path: str) -> int | None:
    """When an ordinary file was written [ns]; None without it."""
    try:
        known = os.lstat(path)
    except OSError:
        return None
    return known.st_mtime_ns if stat.S_ISREG(known.st_mode) else None


def recent_ids(runs: Path, most: int = _NAMED) -> list[str]:
    """Ids of the runs begun last."""
    return [folder.name for folder in run_folders(runs)[:most]]


def find_run(name: str | Path, workspace: str | Path | None = None) -> Path:
    """The folder of a run.

    Args:
        name: Its id, ``last`` for the one begun last, or (only without a workspace) its folder.
        workspace: Where its id is looked for; the current directory by default.

    Raises:
        RunError: There is no such run; the message names recent ones.
    """
    if workspace is None and (Path(name) / META).is_file():
        return Path(name)
    runs = runs_folder(workspace)
    if str(name) == "last":
        folders = run_folders(runs)
        if folders:
            return folders[0]
    folder = runs / str(name)
    if ID.fullmatch(str(name)) and not folder.is_symlink() and plain_file(folder, META) is not None:
        used(folder)
        return folder
    recent = recent_ids(runs)
    fix = f"recent ones are {', '.join(recent)}" if recent else "none is kept here"
    raise RunError("unknown-run", f"there is no run {clean(name)!r}", f"{fix}; {_AGAIN}")


def used(folder: str | Path) -> None:
    """Note that a run is used at this moment."""
    with suppress(OSError):
        os.utime(f"{folder}{os.sep}{META}")


def status_of(folder: Path) -> Status:
    """What became of a run. One without a result that nobody writes any more was interrupted."""
    if plain_file(folder, RESULT) is not None:
        return "finished"
    meta = json_of(folder, META)
    if isinstance(meta, dict) and meta.get("cancelled") is True:
        return "cancelled"
    if being_written(folder):
        return "running"
    return "finished" if plain_file(folder, RESULT) is not None else "interrupted"


def mark_cancelled(folder: Path) -> None:
    """Note that somebody has stopped a run on purpose; one that has finished stays finished."""
    meta = json_of(folder, META)
    if not isinstance(meta, dict) or plain_file(folder, RESULT) is not None:
        return
    written(folder / META, json.dumps({**meta, "cancelled": True}, indent=1).encode())


def being_written(folder: Path) -> bool:
    """Whether a process that is alive writes a run or a job."""
    path = plain_file(folder, BEGUN) or plain_file(folder, LOCK)
    if path is None:
        return False
    try:
        descriptor = os.open(path, os.O_RDWR)
    except OSError:
        return False
    try:
        free = locked(descriptor, wait=False)
    finally:
        os.close(descriptor)
    if free is None:
        return time.time() - max(entry.stat().st_mtime for entry in (path, folder)) < ABANDONED
    return not free
