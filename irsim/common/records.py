"""Text and JSON from outside, read within limits; whatever is wrong becomes a :class:`ContentError`."""

from __future__ import annotations

import json
import math
import re
import stat
from pathlib import Path
from typing import Any

from pydantic_core import from_json

from irsim.common.text import clean

__all__ = ["MAX_RECORD_BYTES", "ContentError", "read_bytes", "read_json", "read_json_lines", "read_text"]

MAX_RECORD_BYTES = 32 * 1024**2
"""Size of the largest record that is read."""
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


def read_bytes(file: Path, most_bytes: int = MAX_RECORD_BYTES) -> bytes:
    """The bytes of an ordinary file.

    Raises:
        ContentError: There is no such file, it is too large, or it cannot be read.
    """
    try:
        status = file.stat()
        if not stat.S_ISREG(status.st_mode):
            kind = "a folder" if stat.S_ISDIR(status.st_mode) else "a device or pipe"
            raise ContentError(f"it is {kind}, not a file")
        with file.open("rb") as opened:
            content = opened.read(most_bytes + 1)
    except (OSError, ValueError) as error:
        raise ContentError(getattr(error, "strerror", None) or str(error)) from None
    if len(content) > most_bytes:
        raise ContentError("it is too large", f"{max(status.st_size, len(content)):,} bytes", f"up to {most_bytes:,}")
    return content


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
