"""ZIP archives from outside, checked before anything is unpacked, and archives of arrays (``.npz``)."""

from __future__ import annotations

import io
import math
import struct
import tokenize
import warnings
import zipfile
import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from irsim.common.records import ContentError
from irsim.common.text import clean

__all__ = ["opened_archive", "pack_arrays", "read_array", "unpack_arrays"]

_END, _END_SIZE = b"PK\x05\x06", 22
_LOCATOR, _LOCATOR_SIZE = b"PK\x06\x07", 20
_RECORD, _RECORD_SIZE = b"PK\x06\x06", 56
_COMMENT_SIZE = 1 << 16
"""Largest comment behind the end of an archive."""
_ENTRY_BYTES = 1024
"""Most bytes of an entry in the directory: 46, its name, and what libraries fill up with (PyTorch: up to 64)."""
_HEADER_BYTES = 4096
"""Longest header of an array."""
_MAX_SIDES = 4
_BROKEN = (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, ValueError, KeyError, OSError,
           OverflowError, SyntaxError, TypeError, MemoryError, IndexError, AttributeError, struct.error,
           tokenize.TokenError, RecursionError)  # fmt: skip
"""Exceptions of the modules that read archives and array headers, on broken files."""


@contextmanager
def opened_archive(
    source: bytes | Path, *, most_bytes: int, most_entries: int, packed: bool = True
) -> Iterator[zipfile.ZipFile]:
    """A ZIP archive whose directory is within the limits: no entry twice, none encrypted.

    The end of the file is looked at first, because :mod:`zipfile` reads a directory however long it is.
    Exceptions of :mod:`zipfile` for a broken archive, also later while it is open, become a ``ContentError``.

    Args:
        source: The content of the file, or its path.
        most_bytes: Largest size of all entries, unpacked.
        most_entries: Largest number of entries.
        packed: Whether entries may be compressed.

    Raises:
        ContentError: It is not such an archive.
    """
    try:
        with io.BytesIO(source) if isinstance(source, bytes) else source.open("rb") as file:
            _check_end(_tail(file), most_entries)
            file.seek(0)
            if file.read(2) != b"PK":
                raise ContentError("it does not begin as an archive does")
            with zipfile.ZipFile(file) as archive:
                _check_entries(archive.infolist(), most_bytes, packed)
                yield archive
    except _BROKEN as error:
        what = f"it is not a readable archive ({clean(str(error) or type(error).__name__, 100)})"
        raise ContentError(what) from None


def _tail(file: Any) -> bytes:
    """The last bytes, up to the end record."""
    size = file.seek(0, io.SEEK_END)
    file.seek(max(0, size - _END_SIZE - _COMMENT_SIZE - _LOCATOR_SIZE - _RECORD_SIZE))
    tail: bytes = file.read()
    at = len(tail) - _END_SIZE
    if not (tail[max(at, 0) :].startswith(_END) and tail.endswith(b"\0\0")):
        at = tail.rfind(_END)
    if at < 0 or at + _END_SIZE > len(tail):
        raise ContentError("it does not end as an archive does; it may be truncated")
    return tail[: at + _END_SIZE]


def _check_end(tail: bytes, most: int) -> None:
    end, before = tail[-_END_SIZE:], tail[:-_END_SIZE]
    count, size = int.from_bytes(end[10:12], "little"), int.from_bytes(end[12:16], "little")
    if before[-_LOCATOR_SIZE:].startswith(_LOCATOR):  # numbers that do not fit are in a record of their own
        record = before[-_RECORD_SIZE - _LOCATOR_SIZE : -_LOCATOR_SIZE]
        if not record.startswith(_RECORD):
            raise ContentError("its directory is broken")
        count = max(count if count < 0xFFFF else 0, int.from_bytes(record[32:40], "little"))
        size = max(size if size < 0xFFFFFFFF else 0, int.from_bytes(record[40:48], "little"))
    if count > most or size > most * _ENTRY_BYTES:
        raise ContentError("its directory is too large", f"{count} entries, {size} bytes", f"up to {most} entries")


def _check_entries(entries: Sequence[zipfile.ZipInfo], most: int, packed: bool) -> None:
    if len({entry.filename for entry in entries}) < len(entries):
        raise ContentError("two entries of the archive have the same name")
    known = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED) if packed else (zipfile.ZIP_STORED,)
    for entry in entries:
        if entry.flag_bits & 1 or entry.compress_type not in known:
            what = "an entry of the archive is encrypted, or compressed in an unknown way"
            raise ContentError(what if packed else "an entry of the archive is encrypted or compressed",
                               place=entry.filename)  # fmt: skip
        if not packed and entry.file_size != entry.compress_size:
            raise ContentError("an entry of the archive has two sizes", place=entry.filename)
    total = sum(entry.file_size for entry in entries)
    if total > most:
        raise ContentError("too large when unpacked", f"{total} bytes", f"up to {most}")


def pack_arrays(arrays: Mapping[str, NDArray[Any]]) -> bytes:
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


def unpack_arrays(
    content: bytes, kinds: Sequence[str], *, most_bytes: int, most_arrays: int
) -> dict[str, NDArray[Any]]:
    """The arrays of an ``.npz`` file, read without NumPy's loader; no object is ever unpickled.

    Args:
        content: The file.
        kinds: Accepted types of numbers, such as ``f4``.
        most_bytes: Largest size of all arrays.
        most_arrays: Largest number of arrays.

    Raises:
        ContentError: The file is of another kind, or over the limits.
    """
    with opened_archive(content, most_bytes=most_bytes, most_entries=most_arrays) as archive:
        entries = archive.infolist()
        for entry in entries:
            if not entry.filename.endswith(".npy"):
                raise ContentError("only arrays (.npy) are read", place=entry.filename)
        return {entry.filename.removesuffix(".npy"): read_array(archive, entry, kinds) for entry in entries}


def read_array(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, kinds: Sequence[str]) -> NDArray[Any]:
    """An array of an archive that :func:`opened_archive` has opened; it may be read-only.

    Args:
        archive: The archive.
        entry: The entry, an ``.npy`` file.
        kinds: Accepted types of numbers, such as ``f4``.

    Raises:
        ContentError: The entry is not such an array.
    """
    data, place = archive.read(entry), entry.filename.removesuffix(".npy")
    stream = io.BytesIO(data)
    version = npy.read_magic(stream)
    readers: dict[Any, Any] = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}
    if version not in readers:
        raise ContentError("unknown version of .npy", ".".join(map(str, version)), "1.0, 2.0", place=place)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about escape sequences of broken headers
        shape, by_columns, dtype = readers[version](stream, max_header_size=_HEADER_BYTES)
    if dtype.hasobject or dtype.str[1:] not in kinds:
        names = ", ".join(np.dtype(kind).name for kind in kinds)
        raise ContentError("arrays hold plain numbers", clean(str(dtype), 60), names, place=place)
    rest = data[stream.tell() :]
    if len(shape) > _MAX_SIDES or any(side < 0 for side in shape) or math.prod(shape) * dtype.itemsize != len(rest):
        raise ContentError("the shape does not fit the data", clean(str(shape), 60), f"{len(rest)} bytes", place=place)
    array = np.frombuffer(rest, dtype=dtype).reshape(shape, order="F" if by_columns else "C")
    return np.ascontiguousarray(array, dtype=dtype.newbyteorder("="))
