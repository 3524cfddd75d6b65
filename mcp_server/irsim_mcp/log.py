"""The log of the server on standard error, which needs no files and blocks nothing if it is not read."""

from __future__ import annotations

import linecache
import logging
import os
import select
import sys
import tokenize
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import ModuleType

__all__ = ["log_to_stderr", "without_rich"]

_STDERR = 2
_MOST = 4000
"""Number of bytes of one message; a pipe takes as many at once when it takes any."""


def log_to_stderr() -> None:
    """Send warnings and errors of all libraries to standard error, in place of what they would set up."""
    logging.basicConfig(level=logging.WARNING, format="%(levelname)s: %(message)s", handlers=[_Plain()], force=True)
    linecache.getlines(tokenize.__file__)  # everything that a traceback imports, while there are descriptors


@contextmanager
def without_rich() -> Iterator[None]:
    """Have the SDK find no Rich in the block: its log would import that, 57 modules, and is not used."""
    if "rich" in sys.modules:
        yield
        return
    modules: dict[str, ModuleType | None] = sys.modules  # type: ignore[assignment]  # None: there is no such module
    modules["rich"] = None
    try:
        yield
    finally:
        del modules["rich"]


class _Plain(logging.Handler):
    """Writes messages without a buffer, and skips each message that would have to wait for a reader."""

    def emit(self, record: logging.LogRecord) -> None:
        with suppress(Exception):  # a log must not end a server
            data = self.format(record).encode("utf-8", "backslashreplace")
            if len(data) > _MOST:
                data = data[: _MOST // 4] + b"\n...\n" + data[-_MOST // 2 :]
            if sys.platform == "win32" or select.select([], [_STDERR], [], 0)[1]:
                os.write(_STDERR, data + b"\n")
