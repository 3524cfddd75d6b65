"""A file with one line for each call of a tool: what was asked, and how much there was to read in the answer."""

from __future__ import annotations

import base64
import binascii
import json
import math
import os
import stat
import struct
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from mcp.types import CallToolResult, ImageContent, InputRequiredResult, TextContent

from irsim.diagnostics.report import error_codes

__all__ = ["CallLog", "CallLogRefused"]

_CHARACTERS_PER_TOKEN = 4
_PIXELS_PER_TOKEN = 750
_MAX_ARGUMENT_CHARACTERS = 500_000
"""Longer arguments are left out of the file; their size is still recorded."""
_PNG_START = 24
"""Bytes of a PNG file up to the end of its width and height."""


class CallLogRefused(ValueError):
    """The file cannot be written, or should not be."""


class CallLog:
    """Appends a line of JSON for each call, before the answer is sent, so that nothing is lost if the server is killed.

    Args:
        path: The file; it is made, and what it holds already is kept.

    Raises:
        CallLogRefused: The file cannot be written, or is not an ordinary file.
    """

    def __init__(self, path: Path) -> None:
        self._begin = time.monotonic()
        self._lock = threading.Lock()
        self._calls = 0
        self._warned = False
        self._file, self._torn = _open(path)

    def now(self) -> float:
        """Time since the server was started [s]."""
        return time.monotonic() - self._begin

    def record(self, tool: str, arguments: Mapping[str, Any], answer: object, begin: float) -> None:
        """Append a line; a full disk ends neither the call nor the server.

        Args:
            tool: Name of the tool.
            arguments: Its arguments, as they were given.
            answer: Its result, or the exception that it raised.
            begin: When the call began, as :meth:`now` says [s].
        """
        asked = _as_json(arguments)
        characters, pictures = _sizes(answer)
        pixels = sum(width * height for width, height in pictures)
        tokens = (len(asked) + characters) / _CHARACTERS_PER_TOKEN + pixels / _PIXELS_PER_TOKEN
        kept = arguments if 0 < len(asked) <= _MAX_ARGUMENT_CHARACTERS else None
        now = self.now()
        with self._lock:
            self._calls += 1
            line = {
                "call": self._calls,
                "at_s": round(begin, 3),
                "took_s": round(now - begin, 3),
                "tool": tool,
                "arguments": kept,
                "error": not isinstance(answer, (CallToolResult, InputRequiredResult))
                or bool(getattr(answer, "is_error", False)),
                "argument_characters": len(asked),
                "answer_characters": characters,
                "pictures": pictures,
                "tokens": math.ceil(tokens),
                "codes": error_codes(_text(answer)),
            }
            self._append(_as_json(line).encode("utf-8", "backslashreplace"))

    def _append(self, line: bytes) -> None:
        """Write a line with one call of the operating system; one that was cut off before it is ended first."""
        data = (b"\n" if self._torn else b"") + line + b"\n"
        try:
            self._torn = os.write(self._file, data) < len(data)
        except OSError as error:
            if not self._warned:
                print(f"irsim-mcp: --log-calls: {error.strerror or error}; a call is missing there", file=sys.stderr)
            self._warned = True


def _open(path: Path) -> tuple[int, bool]:
    """Open an ordinary file for appending.

    Returns:
        Its descriptor, and whether its last line was cut off.

    Raises:
        CallLogRefused: It cannot be opened, or is a folder, device or pipe, or is where messages to the client go.
    """
    flags = os.O_APPEND | os.O_CREAT | os.O_RDWR | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    try:
        file = os.open(path, flags, 0o600)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise CallLogRefused(f"--log-calls: {path} cannot be written: {reason}; choose a file of your own") from None
    status = os.fstat(file)
    if not stat.S_ISREG(status.st_mode) or _is_stdout(status):
        os.close(file)
        raise CallLogRefused(f"--log-calls: {path} is not an ordinary file; choose a file of your own")
    if not status.st_size:
        return file, False
    os.lseek(file, -1, os.SEEK_END)
    return file, os.read(file, 1) != b"\n"


def _is_stdout(status: os.stat_result) -> bool:
    try:
        return os.path.samestat(status, os.fstat(1))
    except OSError:
        return False


def _sizes(answer: object) -> tuple[int, list[tuple[int, int]]]:
    """Number of characters of an answer, and width and height of each of its pictures [pixels]."""
    if not isinstance(answer, CallToolResult):
        return (len(str(answer)) if isinstance(answer, Exception) else 0), []
    return _content_sizes(answer.content)


def _text(answer: object) -> str:
    """The texts of an answer, or of the exception in its place."""
    content = answer.content if isinstance(answer, CallToolResult) else ()
    texts = [block.text for block in content if isinstance(block, TextContent)]
    return "\n".join(texts) if texts or not isinstance(answer, Exception) else str(answer)


def _content_sizes(content: Sequence[Any]) -> tuple[int, list[tuple[int, int]]]:
    characters, pictures = 0, []
    for block in content:
        if isinstance(block, TextContent):
            characters += len(block.text)
        elif isinstance(block, ImageContent):
            pictures.append(_picture_size(block.data))
        else:
            characters += len(block.model_dump_json(exclude_none=True))
    return characters, pictures


def _picture_size(data: str) -> tuple[int, int]:
    """Width and height of a PNG picture that is given in base64; 0 and 0 for anything else."""
    try:
        start = base64.b64decode(data[: _PNG_START * 4 // 3])
        width, height = struct.unpack(">II", start[16:_PNG_START])
    except (binascii.Error, struct.error, ValueError):
        return 0, 0
    return (width, height) if start.startswith(b"\x89PNG") else (0, 0)


def _as_json(value: object) -> str:
    """JSON without line breaks; nothing where a value is nested too deeply or is not JSON."""
    try:
        return json.dumps(value, ensure_ascii=False, separators=(",", ":"))
    except (TypeError, ValueError, RecursionError):
        return ""
