"""The files of runs: written in one step, and read with errors in terms of runs."""

from __future__ import annotations

import os
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import BaseModel
from pydantic_core import PydanticSerializationError, to_json

from irsim.common.files import Buffer, code_of, create_bytes, replace_bytes, write_all
from irsim.common.json_output import encodable
from irsim.common.records import MAX_RECORD_BYTES, ContentError, read_json, read_text
from irsim.diagnostics.errors import CodedError

__all__ = [
    "DIGEST_LENGTH",
    "Claim",
    "RunError",
    "claim",
    "create_file",
    "json_of",
    "lock_file",
    "plain_file",
    "record_json",
    "refusal",
    "replace_file",
    "text_of",
    "unreadable",
]

DIGEST_LENGTH = 32
"""Characters of a digest by which a changed file is noticed."""


class RunError(CodedError, ValueError):
    """A run cannot be opened, read or written."""


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
        if path.stat().st_size > MAX_RECORD_BYTES:
            raise unreadable(f"'{name}' of run {folder.name} is larger than any that irsim writes")
        return read_text(path)
    except FileNotFoundError:
        return None
    except ContentError as error:
        raise unreadable(f"'{name}' of run {folder.name} cannot be read: {error.message}") from None


def record_json(data: Any, **options: Any) -> bytes:
    """JSON of a file of a run.

    Args:
        data: Plain data, or a model.
        **options: Options of ``pydantic_core.to_json``, such as ``indent``.
    """
    try:
        return to_json(data, **options)
    except PydanticSerializationError:  # the name of a file cannot be decoded
        return to_json(encodable(data.model_dump() if isinstance(data, BaseModel) else data), **options)


def json_of(folder: Path, name: str) -> Any:
    """Data of a JSON file of a run, None without that file.

    Raises:
        RunError: The file is not JSON.
    """
    text = text_of(folder, name)
    if text is None:
        return None
    try:
        return read_json(text)
    except ContentError as error:
        raise unreadable(f"'{name}' of run {folder.name} has been changed: {error.message}") from None


def create_file(target: str | Path, text: bytes) -> None:
    """Write a file of a folder without ``run.json``, which does not count as a run until it has one.

    Raises:
        RunError: The operating system refuses to write it.
    """
    try:
        create_bytes(target, text)
    except OSError as error:
        raise refusal(target, error) from None


def replace_file(target: str | Path, *parts: Buffer) -> None:
    """Write a file of a run in one step, so that no incomplete file is ever seen.

    Raises:
        RunError: The operating system refuses to write it.
    """
    try:
        replace_bytes(target, *parts)
    except OSError as error:
        raise refusal(target, error) from None


def refusal(target: str | Path, error: OSError) -> RunError:
    """The error for a file that the operating system refuses to write."""
    what = f"'{target}' cannot be written: {error.strerror or error}"
    return RunError(code_of(error), what, "check permissions and the space left")


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
            write_all(descriptor, text)
            now = time.time_ns()
            os.utime(file, ns=(now, now))  # systems date files by a clock that stands still for milliseconds
        except BaseException:
            os.close(descriptor)
            raise
    except FileExistsError:
        what = f"'{os.path.dirname(file)}' already contains a run"
        raise RunError("file-exists", what, "name another folder for the run") from None
    except OSError as error:
        raise refusal(file, error) from None
    return Claim(descriptor)


def lock_file(descriptor: int, *, wait: bool, alone: bool = False) -> bool | None:
    """Lock an open file until it is closed.

    Args:
        descriptor: The file.
        wait: Wait for other processes, and lock it for this process alone.
        alone: Lock it for this process alone, without waiting.

    Returns:
        Whether the lock was acquired; None on systems without such locks.
    """
    try:
        import fcntl
    except ImportError:
        return None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX if wait else (fcntl.LOCK_EX if alone else fcntl.LOCK_SH) | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
