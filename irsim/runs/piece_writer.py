"""Writes the pieces of a run in a thread, so that the simulation goes on meanwhile."""

from __future__ import annotations

from collections.abc import Callable
from threading import Lock, Thread

__all__ = ["PieceWriter"]


class PieceWriter:
    """Does one piece of work at a time in a thread of its own.

    The core releases the interpreter while it simulates, and the operating system while it copies bytes, so both go on
    side by side. There is no thread until the first piece is submitted, because short runs have only one.
    """

    def __init__(self) -> None:
        self._lock = Lock()
        self._piece: Callable[[], None] | None = None
        self._error: BaseException | None = None

    def submit(self, write: Callable[[], None]) -> None:
        """Begin a piece of work; the one before must be over, see :meth:`wait`."""
        self._piece = write
        Thread(target=self._do, name="irsim-recorder", daemon=True).start()

    def wait(self) -> None:
        """Wait until the last piece is written, and raise the error that this has raised.

        A piece whose thread has not begun, because an interrupt came while it was started, is written here.
        """
        self._do()
        error, self._error = self._error, None
        if error is not None:
            raise error

    def _do(self) -> None:
        with self._lock:
            write, self._piece = self._piece, None
            try:
                if write is not None:
                    write()
            except BaseException as error:
                self._error = error
