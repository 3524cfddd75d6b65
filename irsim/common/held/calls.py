"""Functions that replace ``open`` and functions of ``os``, and ask which folder is held."""

from __future__ import annotations

import builtins
import errno
import functools
import io
import os
import stat
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from typing import Any

from irsim.common.held.entries import Entries, Entry
from irsim.common.held.folder import BELOW, PAIRS, REAL, Folder

__all__ = ["HELD", "PROCESS", "current", "install"]

_FOLLOWING = ("open", "stat", "access", "utime")
"""Functions that follow a link at the end of a path."""
HELD: ContextVar[Folder | None] = ContextVar("held")
"""The folder that is held in a thread or task; without a value, the one of the process."""
PROCESS: list[Folder] = []
"""The folder that the process holds, if it holds one."""


def current() -> Folder | None:
    """The folder that is held here; None without one."""
    return HELD.get(PROCESS[0] if PROCESS else None)


@functools.cache
def install() -> None:
    """Have ``open`` and the functions of ``os`` ask which folder is held."""
    new: dict[str, Callable[..., Any]] = {
        **{name: _with_path(name) for name in BELOW},
        **{name: _with_two_paths(name) for name in PAIRS},
        "open": _open,
        "lstat": _lstat,
        "chmod": _chmod,
        "readlink": _readlink,
        "scandir": _scandir,
        "listdir": _listdir,
        "getcwd": _getcwd,
    }
    replaced: dict[Any, Callable[..., Any]] = {getattr(REAL, name): function for name, function in new.items()}
    for supported in (os.supports_dir_fd, os.supports_fd, os.supports_follow_symlinks):
        supported.update([replaced[function] for function in supported if function in replaced])
    for name, function in new.items():
        function.__module__, function.__qualname__ = "os", name  # where a pickle finds it
        setattr(os, name, function)
    builtins.open = io.open = replaced[REAL.file] = _file
    for module, kind in (("pathlib", "_NormalAccessor"), ("glob", "_StringGlobber")):
        keeper = getattr(sys.modules.get(module), kind, None)
        for name, value in list(vars(keeper).items()) if keeper is not None else []:
            function = value.__func__ if isinstance(value, staticmethod) else value
            if callable(function) and function in replaced:  # what Python 3.10 and 3.13 have looked up already
                setattr(keeper, name, staticmethod(replaced[function]))


def _with_path(name: str) -> Callable[..., Any]:
    real = getattr(REAL, name)

    @functools.wraps(real)
    def function(path: Any, *arguments: Any, **options: Any) -> Any:
        folder = None if options.get("dir_fd") is not None else current()
        inside = None if folder is None else folder.below(path)
        if folder is None or inside is None:
            return real(path, *arguments, **options)
        follow = name in _FOLLOWING and bool(options.get("follow_symlinks", True))
        if name in _FOLLOWING:
            options["follow_symlinks"] = False
        with _named(path), folder.at(inside, follow) as (descriptor, last):
            return real(last, *arguments, **{**options, "dir_fd": descriptor})

    return function


def _with_two_paths(name: str) -> Callable[..., Any]:
    real = getattr(REAL, name)

    @functools.wraps(real)
    def function(source: Any, target: Any, **options: Any) -> Any:
        folder = current()
        if folder is None or options.get("src_dir_fd") is not None:
            return real(source, target, **options)
        with _named(source, target), _end(folder, source) as first, _end(folder, target) as second:
            descriptors = {"src_dir_fd": first[0], "dst_dir_fd": second[0]}
            more = {"follow_symlinks": False} if name == "link" else {}
            return real(first[1], second[1], **{**options, **descriptors, **more})

    return function


@contextmanager
def _end(folder: Folder, path: Any) -> Iterator[tuple[int | None, Any]]:
    """Descriptor and name of one of two paths; no descriptor for a path that is elsewhere."""
    inside = folder.below(path)
    if inside is None:
        yield None, path
        return
    with folder.at(inside, False) as place:
        yield place


@contextmanager
def _named(path: Any, other: Any = None) -> Iterator[None]:
    """Have errors name the path that the caller knows."""
    try:
        yield
    except OSError as error:
        error.filename = path
        if other is not None:
            error.filename2 = other
        raise


def _open(path: Any, flags: int, mode: int = 0o777, *, dir_fd: int | None = None) -> int:
    folder = current() if dir_fd is None else None
    inside = None if folder is None else folder.below(path)
    if folder is None or inside is None:
        return int(REAL.open(path, flags, mode, dir_fd=dir_fd))
    follow = not flags & (os.O_NOFOLLOW | os.O_EXCL)
    careful = flags & ~os.O_TRUNC | os.O_NOFOLLOW | os.O_NONBLOCK
    with _named(path), folder.at(inside, follow) as (place, name):
        descriptor = int(REAL.open(name, careful, mode, dir_fd=place))
        try:
            known = os.fstat(descriptor)
            writing = flags & (os.O_WRONLY | os.O_RDWR)
            if not stat.S_ISREG(known.st_mode) and not stat.S_ISDIR(known.st_mode):
                raise PermissionError(errno.EPERM, "it is a device or pipe, not a file", path)
            if writing and known.st_nlink > 1 and stat.S_ISREG(known.st_mode):
                raise PermissionError(
                    errno.EPERM, "it has a second name (hard link), through which others see it", path
                )
            if writing and flags & os.O_TRUNC:
                os.ftruncate(descriptor, 0)
            if not flags & os.O_NONBLOCK:
                os.set_blocking(descriptor, True)
        except BaseException:
            os.close(descriptor)
            raise
    return descriptor


def _file(file: Any, mode: str = "r", *arguments: Any, **options: Any) -> Any:
    folder = current()
    if folder is None or isinstance(file, int) or options.get("opener") or len(arguments) > 5:
        return REAL.file(file, mode, *arguments, **options)
    if folder.below(file) is None:
        return REAL.file(file, mode, *arguments, **options)
    return REAL.file(file, mode, *arguments, **{**options, "opener": _opener})


def _opener(path: str, flags: int) -> int:
    return _open(path, flags, 0o666)


def _lstat(path: Any, *, dir_fd: int | None = None) -> os.stat_result:
    return os.stat(path, dir_fd=dir_fd, follow_symlinks=False)


def _chmod(path: Any, mode: int, *, dir_fd: int | None = None, follow_symlinks: bool = True) -> None:
    folder = current() if dir_fd is None else None
    if folder is None or folder.below(path) is None:
        REAL.chmod(path, mode, dir_fd=dir_fd, follow_symlinks=follow_symlinks)
        return
    descriptor = _open(path, os.O_RDONLY | (0 if follow_symlinks else os.O_NOFOLLOW))
    try:
        os.fchmod(descriptor, mode)
    finally:
        os.close(descriptor)


def _readlink(path: Any, *, dir_fd: int | None = None) -> Any:
    folder = current() if dir_fd is None else None
    inside = None if folder is None else folder.below(path)
    if folder is None or inside is None:
        return REAL.readlink(path, dir_fd=dir_fd)
    with _named(path), folder.at(inside, False) as (descriptor, name):
        target = REAL.readlink(name, dir_fd=descriptor)
        folder.inner(os.path.join(os.path.dirname(inside), target))
    return target


def _listdir(path: Any = ".") -> list[Any]:
    folder = current()
    if folder is None or folder.below(path) is None:
        return list(REAL.listdir(path))
    descriptor = _open(path, os.O_RDONLY | os.O_DIRECTORY)
    try:
        return list(REAL.listdir(descriptor))
    finally:
        os.close(descriptor)


def _scandir(path: Any = ".") -> Any:
    folder = current()
    if folder is None or folder.below(path) is None:
        return REAL.scandir(path)
    descriptor = _open(path, os.O_RDONLY | os.O_DIRECTORY)
    entries = []
    try:
        for name in REAL.listdir(descriptor):
            with suppress(FileNotFoundError):
                known = REAL.stat(name, dir_fd=descriptor, follow_symlinks=False)
                entries.append(Entry(os.fsdecode(path), name, known))
    finally:
        os.close(descriptor)
    return Entries(entries)


def _getcwd() -> str:
    folder = current()
    return str(REAL.getcwd()) if folder is None else folder.path
