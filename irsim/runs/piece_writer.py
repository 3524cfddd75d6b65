"""Writes the pieces of a run in a thread, so that the simulation goes on meanwhile."""

from __future__ import annotations

from collections.abc import Callable
from threading import Thread

__all__ = ["PieceWriter"]


class PieceWriter:
    """Does one piece of work at a time in a thread of its own.

    The core releases the interpreter while it simulates, and the operating system while it copies bytes, so both go on
    side by side. There is no thread until the first piece is submitted, because short runs have only one.
    """

    def __init__(self) -> None:
        self._thread: Thread | None = None
        self._error: BaseException | None = None

    def submit(self, write: Callable[[], None]) -> None:
        """Begin a piece of work; the one before must be over, see :meth:`wait`."""
        self._thread = Thread(target=self._do, args=(write,), name="irsim-recorder", daemon=True)
        self._thread.start()

    def wait(self) -> None:
        """Wait until the last piece is written, and raise the error that this has raised."""
        if self._thread is not None:
            self._thread.join()
            self._thread = None
        error, self._error = self._error, None
        if error is not None:
            raise error

    def _do(self, write: Callable[[], None]) -> None:
        try:
            write()
        except BaseException as error:
            self._error = error
