"""The files of runs: written so that nobody sees half of one, read with errors in our words. Standard library only."""

from __future__ import annotations

import json
import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from irsim.diagnostics.errors import IrsimError

__all__ = [
    "TEMPORARY",
    "Buffer",
    "Claim",
    "RunError",
    "begun",
    "claim",
    "json_of",
    "lock_file",
    "plain_file",
    "refusal",
    "text_of",
    "unreadable",
    "written",
]

Buffer: TypeAlias = bytes | memoryview
"""Bytes, as they are."""
TEMPORARY = ".new-"
_NEW = os.O_CREAT | os.O_EXCL | os.O_WRONLY | getattr(os, "O_BINARY", 0)
_MAX_TEXT_BYTES = 32 * 1024**2
"""Size of the largest text file that is read."""


class RunError(IrsimError, ValueError):
    """A run that cannot be opened, read or written.

    Attributes:
        code: Code of the closed list in :mod:`irsim.diagnostics.codes`.
        message: What is wrong.
        fix: What to do instead.
        where: The argument that is wrong, if it is not the run itself.
    """

    def __init__(self, code: str, message: str, fix: str | None = None, *, where: str | None = None) -> None:
        self.code, self.message, self.fix, self.where = code, message, fix, where
        super().__init__(f"{code}: {message}" + (f". Fix: {fix}" if fix else ""))


def unreadable(what: str) -> RunError:
    """The error for a file of a run that is damaged or has been changed."""
    return RunError("unreadable-run", what, "run it again: the same scenario and seed give the same run")


def plain_file(folder: Path, name: str) -> Path | None:
    """Path of a file of a run, None if it does not exist or is not an ordinary file."""
    path = folder / name
    return path if path.is_file() and not path.is_symlink() else None


def text_of(folder: Path, name: str) -> str | None:
    """Text of a file of a run, None without that file.

    Raises:
        RunError: The file is too large, or not text.
    """
    path = plain_file(folder, name)
    if path is None:
        return None
    try:
        if path.stat().st_size > _MAX_TEXT_BYTES:
            raise unreadable(f"'{name}' of run {folder.name} is larger than any that irsim writes")
        return path.read_text(encoding="utf-8")
    except FileNotFoundError:
        return None
    except UnicodeDecodeError:
        raise unreadable(f"'{name}' of run {folder.name} is not text") from None


def json_of(folder: Path, name: str) -> Any:
    """Data of a JSON file of a run, None without that file.

    Raises:
        RunError: The file is not JSON.
    """
    text = text_of(folder, name)
    if text is None:
        return None
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        raise unreadable(f"'{name}' of run {folder.name} is not JSON: it has been changed") from None


def begun(target: str | Path, text: bytes) -> None:
    """Write a file of a folder that has no ``run.json`` yet: nobody takes that for a run, so half a file harms nobody.

    Raises:
        RunError: The system refuses.
    """
    try:
        _put(os.open(target, _NEW, 0o600), text)
    except OSError as error:
        raise refusal(target, error) from None


def written(target: str | Path, *parts: Buffer) -> None:
    """Write a file of a run by way of a temporary one, so that nobody ever sees half of it.

    Raises:
        RunError: The system refuses.
    """
    head, separator, _ = os.fspath(target).rpartition(os.sep)
    temporary = f"{head}{separator}{TEMPORARY}{os.urandom(4).hex()}"
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
        raise refusal(target, error) from None


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


def refusal(target: str | Path, error: OSError) -> RunError:
    """The error for a file that the operating system refuses to write."""
    what = f"'{target}' cannot be written: {error.strerror or error}"
    return RunError("file-access", what, "check permissions and the space left")


@dataclass(frozen=True)
class Claim:
    """Marks a run or a job as being written, until it is released or this process ends."""

    descriptor: int

    def release(self) -> None:
        """Mark the run or job as no longer being written."""
        os.close(self.descriptor)


def claim(file: str | Path, text: bytes = b"") -> Claim:
    """Mark a run or a job as being written by this process.

    Args:
        file: The file to create and to lock: ``scenario.yaml`` of a run, ``lock`` of a job.
        text: Content of the file.

    Raises:
        RunError: The file exists already, or the operating system refuses to write it.
    """
    try:
        descriptor = os.open(file, os.O_CREAT | os.O_EXCL | os.O_RDWR | getattr(os, "O_BINARY", 0), 0o600)
        try:
            lock_file(descriptor, wait=True)
            _write(descriptor, text)
        except BaseException:
            os.close(descriptor)
            raise
    except FileExistsError:
        what = f"'{os.path.dirname(file)}' already contains a run"
        raise RunError("file-exists", what, "name another folder for the run") from None
    except OSError as error:
        raise refusal(file, error) from None
    return Claim(descriptor)


def lock_file(descriptor: int, *, wait: bool) -> bool | None:
    """Lock an open file until it is closed.

    Returns:
        Whether the lock was acquired; None on systems without such locks.
    """
    try:
        import fcntl
    except ImportError:
        return None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX if wait else fcntl.LOCK_SH | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
