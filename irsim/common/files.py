"""Writing files in one step, so that no incomplete file is ever seen, and without overwriting by accident."""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from shutil import rmtree
from tempfile import TemporaryDirectory
from typing import TypeAlias

from irsim.common.held import elsewhere
from irsim.common.text import clean
from irsim.diagnostics.errors import CodedError

__all__ = [
    "TEMPORARY",
    "Buffer",
    "TargetError",
    "check_new",
    "check_suffix",
    "code_of",
    "create_bytes",
    "is_disk_full",
    "is_stream",
    "make_folder_of",
    "new_folder",
    "replace_bytes",
    "replacing",
    "write_all",
    "write_atomically",
    "write_new",
]

Buffer: TypeAlias = bytes | memoryview
"""Bytes as they are stored."""
TEMPORARY = ".new-"
"""How names of temporary files begin."""
_NEW = os.O_CREAT | os.O_EXCL | os.O_WRONLY | getattr(os, "O_BINARY", 0)


_FULL = frozenset({errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC)})
_FULL_WORDS = ("no space left on device", "disk is full", "quota exceeded", "io_enospc")
"""Words by which libraries in C report a full disk instead of an error number."""


def is_disk_full(error: BaseException | None) -> bool:
    """Whether an error, or one that led to it, says that the disk has no space left."""
    while error is not None:
        text = str(error).lower()
        if getattr(error, "errno", None) in _FULL or any(words in text for words in _FULL_WORDS):
            return True
        error = error.__cause__ or error.__context__
    return False


def code_of(error: BaseException, other: str = "file-access") -> str:
    """The code for a file that cannot be written: ``disk-full``, or another one."""
    return "disk-full" if is_disk_full(error) else other


class TargetError(CodedError, ValueError):
    """A file cannot be written under the given name."""


def check_suffix(target: Path, known: Iterable[str]) -> None:
    """Refuse a file with an unsupported suffix before any work is done.

    Args:
        target: The file.
        known: Supported suffixes, with or without the dot.

    Raises:
        TargetError: The suffix is not supported.
    """
    suffixes = [suffix.lstrip(".") for suffix in known]
    if target.suffix.lower().lstrip(".") not in suffixes:
        raise TargetError("unknown-format", f"{target} has none of the suffixes {', '.join(suffixes)}")


def check_new(target: Path, *, overwrite: bool) -> None:
    """Refuse a file that exists before any work is done.

    Args:
        target: The file.
        overwrite: It may be replaced; a device or a pipe is written to without that.

    Raises:
        TargetError: The file exists and ``overwrite`` is not set, or it is a folder, or a part of its path is a file.
    """
    above = next((folder for folder in target.parents if os.path.lexists(folder)), None)
    if above is not None and not above.is_dir():
        raise _no_folder(above)
    if target.is_dir():
        raise TargetError("file-exists", f"'{clean(target, 200)}' is a folder", "name another file with -o")
    if not overwrite and os.path.lexists(target) and not is_stream(target):
        raise TargetError(
            "file-exists", f"'{clean(target, 200)}' exists", "--force overwrites it, -o names another file"
        )


def make_folder_of(target: Path) -> None:
    """Make the folder of a file to write, if it does not exist.

    Raises:
        TargetError: A part of its path is a file.
    """
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError):
        raise _no_folder(target.parent) from None


def _no_folder(path: Path) -> TargetError:
    return TargetError("file-access", f"'{clean(path, 200)}' is not a folder", "name another file with -o")


def write_new(target: Path, text: str, *, overwrite: bool = False) -> None:
    """Write a text file in one step.

    Args:
        target: The file; its folder is made if it does not exist.
        text: Its content.
        overwrite: Replace a file that exists.

    Raises:
        TargetError: The file exists and ``overwrite`` is not set, or it is a folder.
    """
    check_new(target, overwrite=overwrite)
    make_folder_of(target)
    if not overwrite and not is_stream(target):
        try:
            target.open("x").close()  # claims the name, also against another process
        except FileExistsError:
            check_new(target, overwrite=False)
            raise
    try:
        write_atomically(target, text)
    except BaseException:
        if not overwrite and not is_stream(target):
            with suppress(OSError):
                target.unlink()
        raise


def write_atomically(target: Path, text: str) -> None:
    """Replace a text file in one step; links are followed, and the permissions of the file stay.

    Devices and pipes are written to, as by :func:`replace_bytes`.

    Args:
        target: The file.
        text: Its new content.
    """
    if not is_stream(target):
        target = target.resolve()
    mode = stat.S_IMODE(target.stat().st_mode) if target.is_file() else None
    replace_bytes(target, text.encode(), mode=mode)


def is_stream(target: str | Path) -> bool:
    """Whether a name belongs to a device, pipe or socket, such as ``/dev/null``, which no file may replace."""
    try:
        mode = os.stat(target).st_mode
    except OSError:
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


def _write_stream(target: str | Path, *parts: Buffer) -> None:
    """Write to a device or a pipe; it waits until a pipe has a reader."""
    descriptor = os.open(target, os.O_WRONLY)
    try:
        write_all(descriptor, *parts)
    finally:
        os.close(descriptor)


def replace_bytes(target: str | Path, *parts: Buffer, mode: int | None = 0o600) -> None:
    """Replace a file in one step: another process sees the old content or the new one, never a part of it.

    Args:
        target: The file; its folder must exist.
        *parts: Its new content.
        mode: Permissions; None for a file that a user names: it gets the usual permissions of new files, and a device
            or a pipe of that name is written to.
    """
    if mode is None and is_stream(target):
        _write_stream(target, *parts)
        return
    head, separator, _ = os.fspath(target).rpartition(os.sep)
    temporary = f"{head}{separator}{TEMPORARY}{os.urandom(4).hex()}"
    try:
        create_bytes(temporary, *parts, mode=0o666 if mode is None else 0o600)
    except OSError as error:
        error.filename = os.fspath(target)  # a user knows no other name
        raise
    try:
        if mode not in (None, 0o600):
            os.chmod(temporary, mode)
        os.replace(temporary, target)
    except BaseException:
        with suppress(OSError):
            os.unlink(temporary)
        raise


def create_bytes(target: str | Path, *parts: Buffer, mode: int = 0o600) -> None:
    """Write a file that does not exist yet; if that fails, nothing is left of it.

    Args:
        target: The file; its folder must exist.
        *parts: Its content.
        mode: Permissions, from which the process's umask is taken.
    """
    descriptor = os.open(target, _NEW, mode)
    try:
        try:
            write_all(descriptor, *parts)
        finally:
            os.close(descriptor)
    except BaseException:
        with suppress(OSError):
            os.unlink(target)
        raise


def write_all(descriptor: int, *parts: Buffer) -> None:
    """Write all parts to an open file, without copies and buffers, whose cost short runs would feel."""
    done = os.writev(descriptor, parts) if hasattr(os, "writev") else 0
    if done < sum(map(len, parts)):
        rest = memoryview(b"".join(parts))[done:]
        while rest:
            rest = rest[os.write(descriptor, rest) :]


@contextmanager
def replacing(path: Path, *, overwrite: bool = True) -> Iterator[Path]:
    """Yield a temporary file beside ``path``, which replaces it if the block succeeds and is deleted otherwise.

    This is for encoders that open files by name; the temporary file has the suffix of the path. The folder is made if
    it does not exist. In a folder that is held, the encoder's file is elsewhere and is copied. A device or a pipe gets
    the content of the temporary file, which then is in another folder.

    Raises:
        TargetError: Without ``overwrite``, the file exists now, because another program has written it meanwhile.
    """
    if is_stream(path):
        with TemporaryDirectory(prefix="irsim-") as folder:
            yield Path(folder, path.name)
            _write_stream(path, Path(folder, path.name).read_bytes())
        return
    make_folder_of(path)
    temporary = path.with_name(f".{path.stem}.{os.getpid()}-{id(path):x}{path.suffix}")
    try:
        with _named(path, temporary), elsewhere(temporary) as written:
            if written == temporary:
                _try(written)
            yield written
        if overwrite:
            os.replace(temporary, path)
        else:
            _name(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


@contextmanager
def _named(path: Path, temporary: Path) -> Iterator[None]:
    """Have errors about a temporary file name the one that the user knows."""
    try:
        yield
    except OSError as error:
        if isinstance(error.filename, str | os.PathLike) and os.fspath(error.filename) == os.fspath(temporary):
            error.filename = os.fspath(path)
        raise


def _try(temporary: Path) -> None:
    """Make a file and delete it, before work is done for it: programs that encode films do not say why they fail."""
    try:
        create_bytes(temporary, mode=0o666)
    except FileExistsError:  # another block writes the same file
        return
    except OSError as error:
        error.strerror = f"the file cannot be written ({error.strerror}); name another one"
        raise
    temporary.unlink()


def _name(temporary: Path, path: Path) -> None:
    """Give a file its name; of two programs that do so at once, one gets the error."""
    try:
        os.link(temporary, path)
    except FileExistsError:
        check_new(path, overwrite=False)
        raise
    except OSError:  # a file system without links
        check_new(path, overwrite=False)
        os.replace(temporary, path)


@contextmanager
def new_folder(target: Path) -> Iterator[Path]:
    """Yield a temporary folder beside ``target``, which gets that name if the block succeeds, else is deleted.

    Raises:
        TargetError: There is a file, a device or a pipe of that name.
    """
    if target.exists() and not target.is_dir():
        raise TargetError("file-exists", f"'{clean(target, 200)}' is not a folder", "name another folder with -o")
    make_folder_of(target)
    temporary = target.with_name(f"{TEMPORARY}{os.urandom(4).hex()}")
    try:
        with _named(target, temporary), elsewhere(temporary) as written:
            written.mkdir()
            yield written
        os.rename(temporary, target)
    finally:
        rmtree(temporary, ignore_errors=True)
