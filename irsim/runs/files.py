"""The files of runs: written so that nobody sees half of one, read with errors in our words. Standard library only."""

from __future__ import annotations

import json
import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from irsim.diagnostics.errors import CodedError

__all__ = [
    "TEMPORARY",
    "Buffer",
    "Claim",
    "RunError",
    "begun",
    "claim",
    "json_of",
    "locked",
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
_MOST_TEXT = 32 * 1024**2


class RunError(CodedError, ValueError):
    """A run cannot be opened, read or written."""


def unreadable(what: str) -> RunError:
    """The error for files of a run that are not as they were written."""
    return RunError("unreadable-run", what, "run it again: the same scenario and seed give the same run")


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
        file: The file to make and to lock: ``scenario.yaml`` of a run, ``lock`` of a job.
        text: What it holds.

    Raises:
        RunError: It is there already, or the system refuses.
    """
    try:
        descriptor = os.open(file, os.O_CREAT | os.O_EXCL | os.O_RDWR | getattr(os, "O_BINARY", 0), 0o600)
        try:
            locked(descriptor, wait=True)
            _write(descriptor, text)
        except BaseException:
            os.close(descriptor)
            raise
    except FileExistsError:
        what = f"'{os.path.dirname(file)}' holds a run already"
        raise RunError("file-exists", what, "name another folder for the run") from None
    except OSError as error:
        raise refusal(file, error) from None
    return Claim(descriptor)


def locked(descriptor: int, *, wait: bool) -> bool | None:
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
