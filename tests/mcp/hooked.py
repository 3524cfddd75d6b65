"""The server ``irsim-mcp`` with its workers, all of which swap a place for a link to its double at every opening.

``python -m tests.mcp.hooked CONTROL ARGUMENT…``, in the root of the repository; the file CONTROL says what is swapped,
and :func:`tell` writes it. Nothing of this is part of the product: the command of the workers is replaced here.
"""

from __future__ import annotations

import fcntl
import os
import posix
import sys
from pathlib import Path
from typing import Any

from tests.mcp.swapping import Swap, swap_at_each

__all__ = ["serve", "tell", "work"]

ROOT = Path(__file__).resolve().parents[2]


def tell(control: Path, swap: Swap | None) -> int:
    """Have the processes swap a place from now on, or nothing, once none is at it.

    Returns:
        How often they have swapped what was told before.
    """
    places = "" if swap is None else "\0".join((swap.place, swap.aside, swap.double))
    with control.open("r+", encoding="utf-8") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        count = file.read().count("\n")
        file.seek(0)
        file.truncate()
        file.write(places)
    return count


def _swap(control: str) -> None:
    """Swap what the file says, unless another process is at it, and note that in the file."""
    descriptor = posix.open(control, os.O_RDWR | os.O_APPEND)  # while a folder is held, os has other functions
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        places = posix.read(descriptor, 1 << 14).decode().rstrip("\n").split("\0")
        if len(places) == 3:
            swap = Swap(*map(Path, places))
            try:
                swap.linked = bool(posix.readlink(swap.place))
            except OSError:
                swap.linked = False
            swap()
            posix.write(descriptor, b"\n")
    finally:
        posix.close(descriptor)


def work(control: str) -> None:
    """Do the job of a worker."""
    from irsim_mcp import job

    swap_at_each(lambda: _swap(control))
    job.main()


def serve(control: str, arguments: list[str]) -> None:
    """Serve with workers that swap."""
    from irsim_mcp import __main__, worker

    code = f"import sys; sys.path.insert(0, {str(ROOT)!r}); from tests.mcp import hooked; hooked.work({control!r})"

    def command() -> list[str]:
        return [sys.executable, "-I", "-X", "utf8", "-c", code]

    patched: Any = worker
    patched._command = command
    swap_at_each(lambda: _swap(control))
    __main__.main(arguments)


if __name__ == "__main__":
    serve(sys.argv[1], sys.argv[2:])
