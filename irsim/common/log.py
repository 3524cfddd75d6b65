"""A logger per environment: lines ``YYYY-MM-DD HH:mm | LEVEL | message`` on standard output, and in a file if asked.

Hints go to standard error, once in a process, so that they are neither output nor warnings.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import TextIO

__all__ = ["LEVELS", "Logger"]

LEVELS = {"TRACE": 5, "DEBUG": 10, "INFO": 20, "SUCCESS": 25, "WARNING": 30, "ERROR": 40, "CRITICAL": 50}


_HINTED: set[str] = set()
"""Hints of this process that have been given: the next environment of the same file does not repeat them."""


class Logger:
    """Writes lines of at least ``level``; two environments never share one.

    Args:
        level: Name in :data:`LEVELS`, any case.
        file: Also append every line to this file.

    Raises:
        ValueError: Unknown level.
    """

    def __init__(self, level: str = "INFO", file: str | Path | None = None) -> None:
        name = str(level).upper()
        if name not in LEVELS:
            raise ValueError(f"unknown log level {level!r}: choose one of {', '.join(LEVELS)}")
        self.level = LEVELS[name]
        self.file = Path(file) if file is not None else None
        self._once: set[str] = set()
        self._closed = False

    def _write(self, name: str, message: object, stream: TextIO | None = None) -> None:
        if self._closed or LEVELS[name] < self.level:
            return
        line = f"{time.strftime('%Y-%m-%d %H:%M')} | {name:<8} | {message}"
        print(line, file=stream or sys.stdout)
        if self.file is not None:
            with self.file.open("a", encoding="utf-8") as stream:
                stream.write(line + "\n")

    def close(self) -> None:
        """Write nothing from now on."""
        self._closed = True

    def trace(self, message: object) -> None:
        """Log at TRACE."""
        self._write("TRACE", message)

    def debug(self, message: object) -> None:
        """Log at DEBUG."""
        self._write("DEBUG", message)

    def info(self, message: object) -> None:
        """Log at INFO."""
        self._write("INFO", message)

    def success(self, message: object) -> None:
        """Log at SUCCESS."""
        self._write("SUCCESS", message)

    def warning(self, message: object) -> None:
        """Log at WARNING."""
        self._write("WARNING", message)

    def error(self, message: object) -> None:
        """Log at ERROR."""
        self._write("ERROR", message)

    def critical(self, message: object) -> None:
        """Log at CRITICAL."""
        self._write("CRITICAL", message)

    def warning_once(self, message: str, key: str | None = None) -> None:
        """Log at WARNING the first time this ``key`` (default: the message) is seen, at DEBUG after that."""
        seen = (key or message) in self._once
        self._once.add(key or message)
        write: Callable[[object], None] = self.debug if seen else self.warning
        write(message)

    def hint(self, message: str) -> None:
        """Say on standard error, at INFO and once in a process, what may help."""
        if LEVELS["INFO"] >= self.level and message not in _HINTED:
            _HINTED.add(message)
            self._write("INFO", message, sys.stderr)

    def error_once(self, message: str) -> None:
        """Log at ERROR the first time this message is seen, at DEBUG after that."""
        write: Callable[[object], None] = self.debug if message in self._once else self.error
        self._once.add(message)
        write(message)
