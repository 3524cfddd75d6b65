"""``.npz`` files: ZIP archives of arrays, read without NumPy's loader and written with the same bytes each time."""

from __future__ import annotations

import io
import math
import os
import stat
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy

from irsim.common.text import clean
from irsim.policies.networks.errors import PolicyFileError, Problem
from irsim.policies.networks.limits import Limits
from irsim.policies.networks.values import Array

__all__ = ["pack_arrays", "read_bytes", "unpack_arrays"]

_FIX = "write the file with irsim.policies.networks.save_network, or with numpy.savez and arrays of numbers"
_END, _END_SIZE = b"PK\x05\x06", 22
_LOCATOR, _LOCATOR_SIZE = b"PK\x06\x07", 20
_ENTRY_BYTES = 512
"""Most bytes of an entry in the directory of an archive: 46, its name, and what NumPy adds."""
_HEADER_BYTES = 4096
_KINDS = ("f4", "f8", "u1")
_BROKEN = (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, ValueError, KeyError, OSError,
           OverflowError, SyntaxError, TypeError, MemoryError, IndexError)  # fmt: skip
"""What the modules that read archives and headers raise on broken files."""


def read_bytes(path: Path, most: int, kind: str = "a .npz or .onnx file") -> bytes:
    """The content of a regular file.

    Args:
        path: The file.
        most: Largest size in bytes.
        kind: What the file should be, for messages.

    Raises:
        PolicyFileError: There is no such file, it cannot be read, or it is too large.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
        try:
            status = os.fstat(descriptor)
            regular = stat.S_ISREG(status.st_mode)
            content = _read(descriptor, most + 1) if regular and status.st_size <= most else b""
        finally:
            os.close(descriptor)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "it cannot be opened"
        raise PolicyFileError(clean(str(path)), [Problem("", reason)], f"name {kind}") from None
    if not regular:
        raise PolicyFileError(clean(str(path)), [Problem("", "it is not a file")], f"name {kind}")
    size = max(status.st_size, len(content))
    if size > most:
        large = Problem("", "the file is too large", f"{size} bytes", f"up to {most}")
        raise PolicyFileError(clean(str(path)), [large], "use a smaller network, or raise Limits.file_bytes")
    return content


def _read(descriptor: int, most: int) -> bytes:
    content = bytearray()
    while len(content) < most and (more := os.read(descriptor, min(most - len(content), 1 << 20))):
        content += more
    return bytes(content)


def pack_arrays(arrays: Mapping[str, Array]) -> bytes:
    """An ``.npz`` file of these arrays, in their order; equal arrays give equal bytes."""
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_STORED) as archive:
        for name, array in arrays.items():
            entry = io.BytesIO()
            little = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<"))
            npy.write_array(entry, little, version=(1, 0), allow_pickle=False)
            info = zipfile.ZipInfo(f"{name}.npy", (1980, 1, 1, 0, 0, 0))
            info.create_system = 3
            archive.writestr(info, entry.getvalue())
    return target.getvalue()


def unpack_arrays(content: bytes, source: str, limits: Limits) -> dict[str, Array]:
    """The arrays of an ``.npz`` file: numbers only, as many and as large as the limits allow.

    Sizes are checked in the directory of the archive before anything is unpacked. No object is ever unpickled.

    Args:
        content: The file.
        source: Its name for messages.
        limits: How large it may be.

    Raises:
        PolicyFileError: It is no such file, or it is over the limits.
    """
    try:
        problem = next(_directory_problems(content, limits), None)
        if problem is None:
            with zipfile.ZipFile(io.BytesIO(content)) as archive:
                problem = next(_entry_problems(archive.infolist(), limits), None)
                if problem is None:
                    return {info.filename.removesuffix(".npy"): _array(archive, info) for info in archive.infolist()}
    except PolicyFileError:
        raise
    except _ArrayError as error:
        problem = error.problem
    except _BROKEN as error:
        problem = Problem("", f"it is not a readable .npz file ({clean(str(error) or type(error).__name__, 100)})")
    raise PolicyFileError(source, [problem], _FIX)


class _ArrayError(Exception):
    """An array cannot be used."""

    def __init__(self, name: str, message: str, given: str = "", allowed: str = "") -> None:
        self.problem = Problem(clean(name.removesuffix(".npy"), 100), message, given, allowed)
        super().__init__(message)


def _directory_problems(content: bytes, limits: Limits) -> Iterator[Problem]:
    """What the last bytes say about the directory: ``zipfile`` reads all of it, however long it is."""
    end = content[-_END_SIZE:]
    if len(end) < _END_SIZE or end[:4] != _END:
        yield Problem("", "it does not end as a .npz file does")
        return
    if content[-_END_SIZE - _LOCATOR_SIZE : -_END_SIZE].startswith(_LOCATOR):
        yield Problem("", "it is an archive for more than 4 GB")
    entries, size = int.from_bytes(end[10:12], "little"), int.from_bytes(end[12:16], "little")
    if entries > limits.arrays:
        yield Problem("", "too many arrays", str(entries), f"up to {limits.arrays}")
    if size > limits.arrays * _ENTRY_BYTES:
        yield Problem("", "its directory is too large", f"{size} bytes", f"up to {limits.arrays * _ENTRY_BYTES}")


def _entry_problems(entries: list[zipfile.ZipInfo], limits: Limits) -> Iterator[Problem]:
    names = [info.filename for info in entries]
    if len(entries) > limits.arrays:
        yield Problem("", "too many arrays", str(len(entries)), f"up to {limits.arrays}")
    if len(set(names)) < len(names):
        yield Problem("", "two arrays have the same name")
    total = sum(info.file_size for info in entries)
    if total > limits.unpacked_bytes:
        yield Problem("", "too large when unpacked", f"{total} bytes", f"up to {limits.unpacked_bytes}")
    for info in entries:
        if not info.filename.endswith(".npy") or info.flag_bits & 1:
            yield Problem(clean(info.filename, 100), "only arrays (.npy) that are not encrypted are read")
        if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            yield Problem(clean(info.filename, 100), "unknown compression", str(info.compress_type), "stored, deflated")


def _array(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> Array:
    data = archive.read(info)
    stream = io.BytesIO(data)
    version = npy.read_magic(stream)
    readers: dict[Any, Any] = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}
    if version not in readers:
        raise _ArrayError(info.filename, "unknown version of .npy", ".".join(map(str, version)), "1.0, 2.0")
    shape, by_columns, dtype = readers[version](stream, max_header_size=_HEADER_BYTES)
    if dtype.hasobject or dtype.str[1:] not in _KINDS:
        raise _ArrayError(info.filename, "arrays hold plain numbers", clean(str(dtype), 60), "float32, float64, uint8")
    rest = data[stream.tell() :]
    if len(shape) > 4 or any(side < 0 for side in shape) or math.prod(shape) * dtype.itemsize != len(rest):
        raise _ArrayError(info.filename, "the shape does not fit the data", clean(str(shape), 60), f"{len(rest)} bytes")
    array = np.frombuffer(rest, dtype=dtype).reshape(shape, order="F" if by_columns else "C")
    return np.ascontiguousarray(array, dtype=dtype.newbyteorder("="))
