"""Write a file below a folder atomically and never through a link, even if others change the folder meanwhile."""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from irsim.common.files import TEMPORARY
from irsim.common.text import clean
from irsim.runs import RunError
from irsim_mcp.answers import failure

__all__ = ["set_aside", "write_file"]


_BY_DESCRIPTOR = {os.open, os.mkdir, os.link, os.rename, os.unlink, os.stat} <= os.supports_dir_fd
_FOLDER = os.O_RDONLY | getattr(os, "O_DIRECTORY", 0) | getattr(os, "O_NOFOLLOW", 0)
_TEMPORARY = ".new-"


def write_file(root: Path, name: str, data: bytes, overwrite: bool) -> bool:
    """Write a file by renaming a temporary one, so that no reader ever sees half of it.

    Args:
        root: The folder outside which nothing is written.
        name: Checked path of the file relative to it, with ``/``; missing folders are created.
        data: Content of the file.
        overwrite: Whether an existing file may be replaced.

    Returns:
        Whether a file was replaced.

    Raises:
        ToolError: The file exists, a part of the path is a link or not a folder, or the operating system refuses.
    """
    *folders, last = name.split("/")
    try:
        with _open_folder(root, folders) as (folder, descriptor):
            return _write_into(folder, descriptor, last, data, overwrite)
    except FileExistsError:
        what = f"{clean(name)!r} exists already"
        raise failure(
            "file-exists", what, where="path", fix="overwrite=true replaces it; or choose another name"
        ) from None
    except OSError as error:
        what = f"{clean(name)!r} cannot be written: {error.strerror or error}"
        fix = "use folders that are not links, and check permissions and free space"
        raise failure("file-access", what, where="path", fix=fix) from None


@contextmanager
def _open_folder(root: Path, folders: list[str]) -> Iterator[tuple[Path, int | None]]:
    """The folder to write to, and a descriptor of it on systems that support paths relative to descriptors."""
    if not _BY_DESCRIPTOR:
        folder = root.joinpath(*folders)
        folder.mkdir(parents=True, exist_ok=True)
        yield folder, None
        return
    descriptor = os.open(root, _FOLDER & ~getattr(os, "O_NOFOLLOW", 0))
    try:
        for part in folders:
            with suppress(FileExistsError):
                os.mkdir(part, dir_fd=descriptor)
            inner = os.open(part, _FOLDER, dir_fd=descriptor)
            os.close(descriptor)
            descriptor = inner
        yield Path(), descriptor
    finally:
        os.close(descriptor)


def _write_into(folder: Path, descriptor: int | None, name: str, data: bytes, overwrite: bool) -> bool:
    temporary, target = str(folder / f"{_TEMPORARY}{secrets.token_hex(6)}"), str(folder / name)
    file = os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o644, dir_fd=descriptor)
    try:
        with os.fdopen(file, "wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        if not overwrite:
            _rename_to_new(temporary, target, descriptor)
            return False
        there = _exists(target, descriptor)
        os.replace(temporary, target, src_dir_fd=descriptor, dst_dir_fd=descriptor)  # replaces a link, not its target
        return there
    finally:
        with suppress(FileNotFoundError):
            os.unlink(temporary, dir_fd=descriptor)


def _rename_to_new(temporary: str, target: str, descriptor: int | None) -> None:
    """Rename a file atomically to a name that does not exist yet."""
    try:
        os.link(temporary, target, src_dir_fd=descriptor, dst_dir_fd=descriptor)
    except FileExistsError:
        raise
    except (OSError, NotImplementedError):  # a file system without hard links
        if _exists(target, descriptor):
            raise FileExistsError from None
        os.replace(temporary, target, src_dir_fd=descriptor, dst_dir_fd=descriptor)


def _exists(target: str, descriptor: int | None) -> bool:
    try:
        os.stat(target, dir_fd=descriptor, follow_symlinks=False)
    except FileNotFoundError:
        return False
    return True


@contextmanager
def set_aside(target: Path) -> Iterator[None]:
    """Set aside the folder of an earlier export of the same run, which comes back if the new one fails."""
    if not os.path.lexists(target):
        yield
        return
    if target.is_symlink() or not target.is_dir():
        what = f"'{target}' is in the way: it is not a folder of an earlier export"
        raise RunError("file-exists", what, "remove it, or give it another name", where="to")
    aside = target.with_name(f"{TEMPORARY}{os.urandom(4).hex()}")
    target.rename(aside)
    try:
        yield
    except BaseException:
        aside.rename(target)
        raise
    shutil.rmtree(aside, ignore_errors=True)
