"""Text and JSON from outside, read within limits; whatever is wrong becomes a :class:`ContentError`."""

from __future__ import annotations

import json
import math
import os
import re
import stat
from pathlib import Path
from typing import Any

from pydantic_core import from_json

from irsim.common.text import clean

__all__ = ["MAX_RECORD_BYTES", "ContentError", "FileError", "read_bytes", "read_json", "read_json_lines", "read_text"]

MAX_RECORD_BYTES = 32 * 1024**2
"""Size of the largest record that is read."""
_READ = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
_BLOCK_BYTES = 1 << 20
_LONG_INTEGER = re.compile(rb"\d{40}")
"""Digits beyond which a number may be an integer that no array holds."""
_HUGE = re.compile(rb"\d{300}|[eE]\+?\d{3}")
"""Text within a number beyond all doubles."""


class ContentError(Exception):
    """The content of a file cannot be used.

    Attributes:
        message: The problem.
        given: The value that is wrong, as text; may be empty.
        allowed: Accepted values, as text; empty if the message says so.
        place: Name of the entry, the array or the like; empty for the file.
        fix: The remedy, or None.
    """

    def __init__(
        self, message: str, given: str = "", allowed: str = "", *, place: str = "", fix: str | None = None
    ) -> None:
        self.message, self.given, self.allowed, self.place = message, given, allowed, clean(place, 100)
        self.fix = fix
        super().__init__(message)


class FileError(ContentError):
    """The bytes of a file cannot be had.

    Attributes:
        code: ``file-not-found``, ``not-a-file``, ``file-too-large`` or ``unreadable``.
        size: Its size in bytes, or what is known of it, if it is too large.
    """

    def __init__(
        self, message: str, given: str = "", allowed: str = "", *, code: str = "unreadable", size: int = 0
    ) -> None:
        super().__init__(message, given, allowed)
        self.code, self.size = code, size


def read_bytes(file: str | Path, most_bytes: int = MAX_RECORD_BYTES, *, follow: bool = True) -> bytes:
    """The bytes of an ordinary file; this never waits, as a pipe would make it.

    Args:
        file: The file.
        most_bytes: Its largest size.
        follow: Whether it may be a link.

    Raises:
        FileError: There is no such file, it is too large, or it cannot be read.
    """
    try:
        _check_kind(os.stat(file, follow_symlinks=follow))
        descriptor = os.open(file, _READ | (0 if follow else getattr(os, "O_NOFOLLOW", 0)))
        try:
            status = os.fstat(descriptor)
            _check_kind(status)  # it may be another one by now
            content = b"" if status.st_size > most_bytes else _read(descriptor, most_bytes + 1)
        finally:
            os.close(descriptor)
    except FileNotFoundError as error:
        raise FileError(error.strerror or str(error), code="file-not-found") from None
    except (OSError, ValueError) as error:
        raise FileError(getattr(error, "strerror", None) or str(error)) from None
    size = max(status.st_size, len(content))
    if size > most_bytes:
        limit = f"up to {most_bytes:,}"
        raise FileError("it is too large", f"{size:,} bytes", limit, code="file-too-large", size=size)
    return content


def _check_kind(status: os.stat_result) -> None:
    if not stat.S_ISREG(status.st_mode):
        kinds = {stat.S_IFDIR: "a folder", stat.S_IFLNK: "a link"}
        kind = kinds.get(stat.S_IFMT(status.st_mode), "a device or pipe")
        raise FileError(f"it is {kind}, not a file", code="not-a-file")


def _read(descriptor: int, most: int) -> bytes:
    content = bytearray()
    while len(content) < most and (more := os.read(descriptor, min(most - len(content), _BLOCK_BYTES))):
        content += more
    return bytes(content)


def read_text(source: bytes | Path, most_bytes: int = MAX_RECORD_BYTES) -> str:
    """Text in UTF-8, without the mark that some editors put at its beginning.

    Raises:
        ContentError: The file cannot be read, or is not text.
    """
    content = source if isinstance(source, bytes) else read_bytes(source, most_bytes)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ContentError(f"it is not UTF-8 text (byte {error.start})") from None
    if "\0" in text:
        raise ContentError("it is not a text file")
    return text


def read_json(
    source: str | bytes | Path, *, most_bytes: int = MAX_RECORD_BYTES, finite: bool = True, unique: bool = False
) -> Any:
    """The data of JSON text, which is nested at most 200 deep and has no half characters.

    Args:
        source: The text, its bytes, or the file.
        most_bytes: Largest size of the file.
        finite: Whether to refuse numbers that are not finite.
        unique: Whether to refuse keys that are given twice; else the last value counts.

    Raises:
        ContentError: The file cannot be read, or is not such JSON.
    """
    content = read_bytes(source, most_bytes) if isinstance(source, Path) else source
    try:
        raw = content.encode() if isinstance(content, str) else content.removeprefix(b"\xef\xbb\xbf")
        data = from_json(raw, allow_inf_nan=not finite, cache_strings="keys")
    except ValueError as error:
        if finite and _is_json(raw):
            raise ContentError("it is not valid JSON: NaN is not a number, and neither is Infinity") from None
        raise ContentError(f"it is not valid JSON ({clean(str(error), 100)})") from None
    if unique:
        json.loads(raw, object_pairs_hook=_once)
    if _LONG_INTEGER.search(raw) or (finite and _HUGE.search(raw)):
        _check_numbers(data, finite)
    return data


def read_json_lines(source: bytes | Path, *, most_bytes: int = MAX_RECORD_BYTES) -> list[Any]:
    """The data of each line of a file.

    Raises:
        ContentError: The file cannot be read, or a line is not JSON.
    """
    lines = read_text(source, most_bytes).splitlines()
    result = []
    for number, line in enumerate(lines, 1):
        try:
            result.append(read_json(line))
        except ContentError as error:
            raise ContentError(f"line {number}: {error.message}") from None
    return result


def _is_json(raw: bytes) -> bool:
    """Whether it is JSON but for numbers that are not finite."""
    try:
        from_json(raw)
    except ValueError:
        return False
    return True


def _once(pairs: list[tuple[str, Any]]) -> None:
    if len(dict(pairs)) < len(pairs):
        raise ContentError("a key is given twice")


def _check_numbers(data: Any, finite: bool) -> None:
    """Refuse integers beyond 128 bits and, if asked, numbers that are not finite."""
    if isinstance(data, dict):
        data = list(data.values())
    if isinstance(data, list):
        for value in data:
            _check_numbers(value, finite)
    elif (isinstance(data, int) and data.bit_length() > 128) or (
        isinstance(data, float) and finite and not math.isfinite(data)
    ):
        raise ContentError("it has a number beyond all that are used")
