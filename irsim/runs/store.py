"""Where runs are kept: names, folders, who is writing, what is let go. Standard library only, no NumPy."""

from __future__ import annotations

import json
import os
import re
import shutil
import stat
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeAlias

from irsim.errors import IrsimError
from irsim.text import clean

__all__ = [
    "ARTIFACTS",
    "BEGUN",
    "DAY",
    "FILES",
    "LOCK",
    "META",
    "QUOTA",
    "RESULT",
    "Buffer",
    "Claim",
    "RunError",
    "Status",
    "begun",
    "claim",
    "find_run",
    "made_folder",
    "mark_cancelled",
    "plain_file",
    "prune",
    "recent_ids",
    "remove",
    "run_folders",
    "runs_folder",
    "status_of",
    "tidy",
    "unreadable",
    "used",
    "written",
]

Buffer: TypeAlias = bytes | memoryview
"""Bytes, as they are."""
Status = Literal["running", "finished", "cancelled", "interrupted"]
META, RESULT, LOCK = "run.json", "result.json", "lock"
BEGUN = "scenario.yaml"
"""Written once, when a run begins, and locked as long as it is written; ``run.json`` is touched by each use."""
FILES = (BEGUN, "resolved.json", META, RESULT)
"""Of every complete run; trace and events are in numbered pieces beside them."""
ARTIFACTS = (*FILES, "events.json", "trace.json", "trace.csv", "replay.json")
"""What there is of a run as text: files, and what is made of the pieces."""
QUOTA = 500 * 1000 * 1000
"""Bytes that the runs of a workspace may take together; the least recently used ones make room."""
DAY = 24 * 3600.0
"""Seconds after its last use that a run is kept."""
_AGAIN = "runs are let go 24 h after their last use: the same scenario and seed give the same run again"
_KEPT_IN = ".irsim"
_LONGEST_STEM = 24
_ID = re.compile(r"[a-z0-9][a-z0-9-]{0,40}-[0-9a-f]{6}")
_NO_SLUG = re.compile(r"[^a-z0-9]+")
_TEMPORARY, _TRASH = ".new-", ".gone-"
_NEW = os.O_CREAT | os.O_EXCL | os.O_WRONLY | getattr(os, "O_BINARY", 0)
_NAMED = 5
_TIDIED = ".tidied"
_BETWEEN_TIDYING = 5.0
"""Seconds: looking at every run before each short one would cost more than the run."""
_MOST_TEXT = 32 * 1024**2
_ABANDONED = 60.0
"""Where files cannot be locked: seconds without a sign of life after which nobody writes any more."""


class RunError(IrsimError, ValueError):
    """A run that cannot be opened, read or written.

    Attributes:
        code: Code of the closed list in :mod:`irsim.codes`.
        message: What is wrong.
        fix: What to do instead.
        where: Argument it is about, if it is not the run itself.
    """

    def __init__(self, code: str, message: str, fix: str | None = None, *, where: str | None = None) -> None:
        self.code, self.message, self.fix, self.where = code, message, fix, where
        super().__init__(f"{code}: {message}" + (f". Fix: {fix}" if fix else ""))


def unreadable(what: str) -> RunError:
    """The error for files of a run that are not as they were written."""
    return RunError("unreadable-run", what, "run it again: the same scenario and seed give the same run")


# folders --------------------------------------------------------------------------------------------------------------


def runs_folder(workspace: str | Path | None = None, *, make: bool = False) -> Path:
    """The folder of all runs of a workspace, by default of the current directory.

    Args:
        workspace: Folder whose ``.irsim/runs`` is meant.
        make: Make it, with a ``.gitignore`` that keeps all of it out of version control.

    Raises:
        RunError: ``.irsim`` or ``runs`` is a link or no folder: nothing is read or written through links.
    """
    top = os.path.join(os.getcwd() if workspace is None else workspace, _KEPT_IN)
    folder = os.path.join(top, "runs")
    for part in (top, folder):
        mode = _mode(part)
        if mode is not None and not stat.S_ISDIR(mode):
            raise RunError("path-outside-workspace", f"'{part}' is a link or no folder", "put a plain folder there")
    if make:
        ignore = os.path.join(top, ".gitignore")
        try:
            if mode is None:
                os.makedirs(folder, exist_ok=True)
        except OSError as error:
            raise _refusal(folder, error) from None
        if _mode(ignore) is None:
            written(ignore, b"*\n")
    return Path(folder)


def _mode(path: str) -> int | None:
    """What kind of thing is there, None without any."""
    try:
        return os.lstat(path).st_mode
    except OSError:
        return None


def made_folder(runs: Path, stem: str) -> Path:
    """A new folder for a run: ``<stem as a slug>-<six hexadecimal digits>``."""
    slug = _NO_SLUG.sub("-", stem.lower())[:_LONGEST_STEM].strip("-") or "scenario"
    while True:
        folder = os.path.join(runs, f"{slug}-{os.urandom(3).hex()}")
        try:
            os.mkdir(folder)
        except FileExistsError:
            continue
        except OSError as error:
            raise _refusal(folder, error) from None
        return Path(folder)


def run_folders(runs: Path) -> list[Path]:
    """The folders of runs, the one begun last first."""
    return _sorted_folders(runs, (BEGUN, META))


def _sorted_folders(runs: Path, dated_by: Sequence[str]) -> list[Path]:
    """The folders of runs, the latest first, by the date of the first of those files that is there."""
    found: list[tuple[int, str, Path]] = []
    with suppress(FileNotFoundError, NotADirectoryError), os.scandir(runs) as entries:
        for entry in entries:
            if _ID.fullmatch(entry.name) and entry.is_dir(follow_symlinks=False):
                with suppress(OSError):  # it may be let go at this moment
                    dates = {name: _date(os.path.join(entry.path, name)) for name in (META, *dated_by)}
                    date = next((dates[name] for name in dated_by if dates[name] is not None), None)
                    if date is not None and dates[META] is not None:
                        found.append((date, entry.name, Path(entry.path)))
    return [folder for _, _, folder in sorted(found, reverse=True)]


def _date(path: str) -> int | None:
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
    if _ID.fullmatch(str(name)) and not folder.is_symlink() and plain_file(folder, META) is not None:
        used(folder)
        return folder
    recent = recent_ids(runs)
    fix = f"recent ones are {', '.join(recent)}" if recent else "none is kept here"
    raise RunError("unknown-run", f"there is no run {clean(name)!r}", f"{fix}; {_AGAIN}")


def used(folder: Path) -> None:
    """Note that a run is used at this moment."""
    with suppress(OSError):
        os.utime(os.path.join(folder, META))


def plain_file(folder: Path, name: str) -> Path | None:
    """A file of a run, None if it is not there or is anything but an ordinary file."""
    path = folder / name
    return path if path.is_file() and not path.is_symlink() else None


def text_of(folder: Path, name: str) -> str | None:
    """Text of a file of a run, None without that file.

    Raises:
        RunError: It is too large, or no text.
    """
    path = plain_file(folder, name)
    if path is None:
        return None
    try:
        if path.stat().st_size > _MOST_TEXT:
            raise unreadable(f"'{name}' of run {folder.name} is larger than irsim writes such files")
        return path.read_text(encoding="utf-8")
    except FileNotFoundError:
        return None
    except UnicodeDecodeError:
        raise unreadable(f"'{name}' of run {folder.name} is not text") from None


def json_of(folder: Path, name: str) -> Any:
    """Data of a JSON file of a run, None without that file.

    Raises:
        RunError: It does not hold JSON.
    """
    text = text_of(folder, name)
    if text is None:
        return None
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        raise unreadable(f"'{name}' of run {folder.name} is not JSON: it has been changed") from None


# writing --------------------------------------------------------------------------------------------------------------


def begun(target: str | Path, text: bytes) -> None:
    """Write a file of a folder that has no ``run.json`` yet: nobody takes that for a run, so half a file harms nobody.

    Raises:
        RunError: The system refuses.
    """
    try:
        _put(os.open(target, _NEW, 0o600), text)
    except OSError as error:
        raise _refusal(target, error) from None


def written(target: str | Path, *parts: Buffer) -> None:
    """Write a file of a run by way of a temporary one, so that nobody ever sees half of it.

    Raises:
        RunError: The system refuses.
    """
    temporary = os.path.join(os.path.dirname(target), f"{_TEMPORARY}{os.urandom(4).hex()}")
    try:
        descriptor = os.open(temporary, _NEW, 0o600)
        try:
            _put(descriptor, *parts)
            os.replace(temporary, target)
        except BaseException:
            with suppress(OSError):
                os.unlink(temporary)
            raise
    except OSError as error:
        raise _refusal(target, error) from None


def _put(descriptor: int, *parts: Buffer) -> None:
    try:
        _write(descriptor, *parts)
    finally:
        os.close(descriptor)


def _write(descriptor: int, *parts: Buffer) -> None:
    """Write all of it, without copies and buffers, which short runs would feel."""
    done = os.writev(descriptor, parts) if hasattr(os, "writev") else 0
    if done < sum(map(len, parts)):
        rest = memoryview(b"".join(parts))[done:]
        while rest:
            rest = rest[os.write(descriptor, rest) :]


def _refusal(target: str | Path, error: OSError) -> RunError:
    """What the system refuses, in our words."""
    what = f"'{target}' cannot be written: {error.strerror or error}"
    return RunError("file-access", what, "check permissions and the space left")


@dataclass(frozen=True)
class Claim:
    """Says that a run or a job is being written, as long as this process lives and until it is released."""

    descriptor: int

    def release(self) -> None:
        """Nobody writes any more."""
        os.close(self.descriptor)


def claim(file: str | Path, text: bytes = b"") -> Claim:
    """Say that this process writes a run or a job.

    Args:
        file: The file to lock: ``scenario.yaml`` of a run, ``lock`` of a job.
        text: What it holds.

    Raises:
        RunError: The system refuses.
    """
    try:
        descriptor = os.open(file, os.O_CREAT | os.O_RDWR | getattr(os, "O_BINARY", 0), 0o600)
        try:
            _locked(descriptor, wait=True)
            _write(descriptor, text)
        except BaseException:
            os.close(descriptor)
            raise
    except OSError as error:
        raise _refusal(file, error) from None
    return Claim(descriptor)


def status_of(folder: Path) -> Status:
    """What became of a run. One without a result that nobody writes any more was interrupted."""
    if plain_file(folder, RESULT) is not None:
        return "finished"
    meta = json_of(folder, META)
    if isinstance(meta, dict) and meta.get("cancelled") is True:
        return "cancelled"
    if _being_written(folder):
        return "running"
    return "finished" if plain_file(folder, RESULT) is not None else "interrupted"


def mark_cancelled(folder: Path) -> None:
    """Note that somebody has stopped a run on purpose; one that has finished stays finished."""
    meta = json_of(folder, META)
    if not isinstance(meta, dict) or plain_file(folder, RESULT) is not None:
        return
    written(folder / META, json.dumps({**meta, "cancelled": True}, indent=1).encode())


def _being_written(folder: Path) -> bool:
    path = plain_file(folder, BEGUN) or plain_file(folder, LOCK)
    if path is None:
        return False
    try:
        descriptor = os.open(path, os.O_RDWR)
    except OSError:
        return False
    try:
        free = _locked(descriptor, wait=False)
    finally:
        os.close(descriptor)
    if free is None:
        return time.time() - max(entry.stat().st_mtime for entry in (path, folder)) < _ABANDONED
    return not free


def _locked(descriptor: int, *, wait: bool) -> bool | None:
    """Lock a file until it is closed; whether that worked, None on systems without such locks."""
    try:
        import fcntl
    except ImportError:
        return None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX if wait else fcntl.LOCK_SH | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


# letting go -----------------------------------------------------------------------------------------------------------


def prune(runs: Path, *, quota: int = QUOTA, age: float = DAY, keep: Path | None = None) -> list[str]:
    """Let go of runs that nobody has used for ``age`` seconds, and of the least recently used ones beyond the quota.

    Runs that are being written stay, and so does ``keep``. Leftovers of processes that were killed are swept up.

    Args:
        runs: Folder of all runs.
        quota: Bytes they may take together.
        age: Seconds after its last use.
        keep: A run that stays.

    Returns:
        Ids of what was let go.
    """
    _sweep(runs)
    sizes = {folder: _size_of(folder) for folder in reversed(_sorted_folders(runs, (META,)))}  # the latest used last
    total, gone, now = sum(size for size, _ in sizes.values()), list[str](), time.time()
    for folder, (size, leftovers) in sizes.items():
        if keep is not None and folder.name == keep.name:
            continue
        try:
            old = now - (folder / META).stat().st_mtime > age
        except OSError:
            continue
        if (old or total > quota) and not _being_written(folder):
            remove(folder)
            gone.append(folder.name)
            total -= size
        elif leftovers and not _being_written(folder):
            _sweep_run(leftovers)
    return gone


def tidy(runs: Path) -> None:
    """:func:`prune`, unless somebody did so a moment ago."""
    mark = os.path.join(runs, _TIDIED)
    with suppress(OSError):
        if 0 <= time.time() - os.stat(mark).st_mtime < _BETWEEN_TIDYING:
            return
    with suppress(OSError):
        Path(mark).touch()
    prune(runs)


def _size_of(folder: Path) -> tuple[int, list[str]]:
    """Bytes of a run, and its temporary files."""
    total, leftovers = 0, list[str]()
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            with suppress(OSError):
                total += entry.stat(follow_symlinks=False).st_size
            if entry.name.startswith(_TEMPORARY):
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
        elif _ID.fullmatch(folder.name) and _date(os.path.join(folder, META)) is None:
            with suppress(OSError):
                young = time.time() - folder.stat().st_mtime < _ABANDONED
                if not young and not _being_written(folder):
                    remove(folder)


def _sweep_run(leftovers: list[str]) -> None:
    """Remove temporary files that a killed process left in a run."""
    for path in leftovers:
        with suppress(OSError):
            if time.time() - os.lstat(path).st_mtime > _ABANDONED:
                os.unlink(path)


def _children(runs: Path) -> Iterator[Path]:
    with suppress(OSError), os.scandir(runs) as entries:
        yield from [Path(entry.path) for entry in entries if entry.is_dir(follow_symlinks=False)]
