"""A folder that is held by a descriptor: no access leaves it, even if links below it change or it is replaced.

Programs check a path and then open it, and in between others may put a link in its place. Below a held folder there is
no such moment: each component is opened from the descriptor of the one above it, by calls that follow no link. A link
is read and its target walked in the same way, if it stays in the folder; one that leads out is refused. Pipes, devices
and, for writing, further names of a file (hard links) are refused, too.

While a folder is held, the functions of Python that take paths do so for all paths below it: ``open``, the functions
of ``os`` and, through them, ``pathlib``, ``shutil``, NumPy, Pillow and the like. Relative paths start at the folder.
Libraries that open files themselves do not: what they write goes to :func:`apart` first. Without ``dir_fd`` (Windows)
nothing is held.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from irsim.common.held.calls import HELD, PROCESS, current, install
from irsim.common.held.folder import AVAILABLE, Folder

__all__ = ["AVAILABLE", "Folder", "current", "elsewhere", "for_children", "hold", "hold_for_good", "not_held"]


@contextmanager
def hold(folder: Folder | None) -> Iterator[None]:
    """Hold a folder in the block, in this thread or task; None holds nothing."""
    if folder is not None:
        install()
    token = HELD.set(folder)
    try:
        yield
    finally:
        HELD.reset(token)


def hold_for_good(path: str, descriptor: int) -> None:
    """Hold a folder from now on, in all threads of this process, by a descriptor that its parent has passed on."""
    install()
    PROCESS[:] = [Folder(path, descriptor)]


def not_held() -> AbstractContextManager[None]:
    """Hold no folder in the block, which names only files of the program itself."""
    return hold(None)


@contextmanager
def elsewhere(target: Path) -> Iterator[Path]:
    """Where to write a file or folder by a library that opens files itself: elsewhere while a folder is held.

    Args:
        target: The wanted file or folder, which does not exist yet; it is there after the block.
    """
    if current() is None:
        yield target
        return
    with TemporaryDirectory(prefix="irsim-") as private:
        written = Path(private, target.name)
        yield written
        if written.is_dir():
            shutil.copytree(written, target, copy_function=shutil.copyfile)
        else:
            shutil.copyfile(written, target)


def for_children() -> tuple[str, tuple[int, ...]]:
    """A statement with which a Python child process holds the same folder, and the descriptors that it inherits."""
    if not PROCESS:
        return "", ()
    path, descriptor = PROCESS[0].path, PROCESS[0].descriptor
    return f"from irsim.common.held import hold_for_good; hold_for_good({path!r}, {descriptor}); ", (descriptor,)
