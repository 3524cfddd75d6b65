"""Commands to worker processes and their answers, over pipes."""

from __future__ import annotations

import os
import pickle
import struct
from typing import Any

__all__ = ["DONE", "packed_error", "read_exactly", "read_message", "unpacked_error", "write_message"]

DONE = b"\0"
"""First byte of an answer: the command was carried out. Any other one is followed by an error as a message."""
_LENGTH = struct.Struct("<Q")
_BUFFER = 65536


def write_message(file: int, message: Any, first: bytes = b"") -> None:
    """Write a message to a pipe, after some bytes.

    Raises:
        OSError: Nobody reads the pipe.
    """
    data = pickle.dumps(message, pickle.HIGHEST_PROTOCOL)
    rest = memoryview(first + _LENGTH.pack(len(data)) + data)
    while rest:
        rest = rest[os.write(file, rest) :]


def read_message(file: int) -> Any:
    """Read a message from a pipe.

    Raises:
        EOFError: The pipe was closed.
    """
    (length,) = _LENGTH.unpack(read_exactly(file, _LENGTH.size))
    return pickle.loads(read_exactly(file, length))


def read_exactly(file: int, length: int) -> bytes:
    """Read a number of bytes from a pipe.

    Raises:
        EOFError: The pipe was closed.
    """
    parts, left = [], length
    while left:
        part = os.read(file, min(left, _BUFFER))
        if not part:
            raise EOFError
        parts.append(part)
        left -= len(part)
    return parts[0] if len(parts) == 1 else b"".join(parts)


def packed_error(error: BaseException) -> Any:
    """An error as a message: its class, arguments and attributes, and its text in case that those cannot be sent."""
    text = f"{type(error).__name__}: {error}"
    given = (type(error), error.args, error.__dict__)
    try:
        return (*given, text) if isinstance(_rebuilt(*pickle.loads(pickle.dumps(given))), type(error)) else (text,)
    except Exception:  # anything may happen in classes of others
        return (text,)


def unpacked_error(message: Any) -> BaseException:
    """The same error in another process; a RuntimeError with its text if it could not be sent."""
    *given, text = message
    return _rebuilt(*given) if given else RuntimeError(text)


def _rebuilt(kind: type[BaseException], args: tuple[Any, ...], values: dict[str, Any]) -> BaseException:
    """An error made without its constructor, whose arguments are not known."""
    error = kind.__new__(kind, *args)
    error.args = args
    error.__dict__.update(values)
    return error
