"""Both formats that ``torch.save`` writes: ZIP archives since version 1.6, and pickles one after the other before."""

from __future__ import annotations

import io
import zipfile
import zlib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from irsim.common.text import clean
from irsim.policies.converters.torch_files.pickles import PickleError, read_pickle
from irsim.policies.converters.torch_files.tensors import ITEM_BYTES, TensorError, arrays_of, named_tensors
from irsim.policies.networks.archive import read_bytes
from irsim.policies.networks.errors import PolicyFileError, Problem
from irsim.policies.networks.limits import LIMITS, Limits
from irsim.policies.networks.values import Array

__all__ = ["parse_torch", "read_torch"]

_FIX = "save the weights with torch.save(model.state_dict(), FILE)"
_MAGIC, _PROTOCOL = 0x1950A86A20F9469CFC6C, 1001
"""First two objects of the old format."""
_END_SIZE, _LOCATOR_SIZE, _RECORD_SIZE = 22, 20, 56
_ENTRY_BYTES = 1024
"""Most bytes of an entry in the directory of an archive: PyTorch fills entries up to 64 bytes."""
_BROKEN = (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, ValueError, KeyError, OSError,
           OverflowError, MemoryError, IndexError, AttributeError)  # fmt: skip
"""What :mod:`zipfile` raises on broken archives."""


class _FileError(Exception):
    """The file as a whole cannot be used."""

    def __init__(self, message: str, given: str = "", allowed: str = "") -> None:
        self.problem = Problem("", message, given, allowed)
        super().__init__(message)


def read_torch(path: str | Path, limits: Limits = LIMITS) -> dict[str, Array]:
    """The tensors of a file that ``torch.save`` wrote, by name; no code of the file runs and torch is not needed.

    Args:
        path: The file: a state dictionary, a whole module, or a mapping that contains them.
        limits: How large it may be.

    Returns:
        Name -> array of float32. Names of modules inside others are joined by dots, as in a state dictionary.

    Raises:
        PolicyFileError: It is no such file, it is over the limits, or a tensor cannot be used.
    """
    return parse_torch(read_bytes(Path(path), limits.file_bytes, "a file that torch.save wrote"), str(path), limits)


def parse_torch(content: bytes, source: str, limits: Limits = LIMITS) -> dict[str, Array]:
    """The tensors of the bytes of such a file.

    Args:
        content: The bytes.
        source: Name of the file for messages.
        limits: How large it may be.

    Raises:
        PolicyFileError: As :func:`read_torch`.
    """
    try:
        read = _archive if content.startswith(b"PK") else _pickles
        return read(content, limits)
    except _FileError as error:
        problem = error.problem
    except PickleError as error:
        problem = Problem("", str(error))
    except TensorError as error:
        problem = Problem(error.where, error.message, error.given, error.allowed)
    raise PolicyFileError(clean(source), [problem], _FIX)


# the archive ----------------------------------------------------------------------------------------------------------
def _archive(content: bytes, limits: Limits) -> dict[str, Array]:
    _check_directory(content, limits)
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            entries = _entries(archive)
            root = _root(entries)
            if f"{root}constants.pkl" in entries:
                raise _FileError("it is a program of TorchScript, not weights")
            order = _unpack(archive, entries.get(f"{root}byteorder"), limits)
            if order.strip() not in (b"", b"little"):
                raise _FileError("its numbers are big-endian")
            pickle = _unpack(archive, entries[f"{root}data.pkl"], limits)
            tensors = named_tensors(read_pickle(io.BytesIO(pickle)), limits)
            keys = {tensor.storage.key: entries.get(f"{root}data/{tensor.storage.key}") for tensor in tensors.values()}
            total = sum(info.file_size for info in keys.values() if info is not None)
            if total > limits.unpacked_bytes:
                raise _FileError("too large when unpacked", f"{total} bytes", f"up to {limits.unpacked_bytes}")
            storages = {key: _unpack(archive, info, limits) for key, info in keys.items() if info is not None}
    except (PickleError, TensorError, _FileError):
        raise
    except _BROKEN as error:
        what = f"it is not a readable archive ({clean(str(error) or type(error).__name__, 100)})"
        raise _FileError(what) from None
    return arrays_of(tensors, storages, limits)


def _check_directory(content: bytes, limits: Limits) -> None:
    """Refuse a directory with too many entries before :mod:`zipfile` reads it."""
    end = content[-_END_SIZE:]
    if len(end) < _END_SIZE or not end.startswith(b"PK\x05\x06"):
        raise _FileError("it does not end as an archive does; it may be truncated")
    count, size = int.from_bytes(end[10:12], "little"), int.from_bytes(end[12:16], "little")
    behind = len(content) - _END_SIZE - _LOCATOR_SIZE
    if behind >= 0 and content[behind:].startswith(b"PK\x06\x07"):
        record = content[max(behind - _RECORD_SIZE, 0) : behind]
        if not record.startswith(b"PK\x06\x06"):
            raise _FileError("its directory is broken")
        count = max(count if count < 0xFFFF else 0, int.from_bytes(record[32:40], "little"))
        size = max(size if size < 0xFFFFFFFF else 0, int.from_bytes(record[40:48], "little"))
    most = limits.arrays + 16
    if count > most or size > most * _ENTRY_BYTES:
        raise _FileError("its directory is too large", f"{count} entries, {size} bytes", f"up to {most} entries")


def _entries(archive: zipfile.ZipFile) -> dict[str, zipfile.ZipInfo]:
    infos = archive.infolist()
    entries = {info.filename: info for info in infos}
    if len(entries) < len(infos):
        raise _FileError("two entries of the archive have the same name")
    return entries


def _root(entries: Mapping[str, Any]) -> str:
    """Folder of the archive that everything lies in, with its slash."""
    found = [name.removesuffix("data.pkl") for name in entries if name == "data.pkl" or name.endswith("/data.pkl")]
    if len(found) != 1:
        raise _FileError("it is an archive, but not one that torch.save wrote: it has no data.pkl")
    return found[0]


def _unpack(archive: zipfile.ZipFile, info: zipfile.ZipInfo | None, limits: Limits) -> bytes:
    """The bytes of an entry; empty if there is none."""
    if info is None:
        return b""
    if info.file_size > limits.unpacked_bytes:
        raise _FileError("too large when unpacked", f"{info.file_size} bytes", f"up to {limits.unpacked_bytes}")
    if info.flag_bits & 1 or info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise _FileError("an entry of the archive is encrypted, or compressed in an unknown way")
    return archive.read(info)


# pickles one after the other ------------------------------------------------------------------------------------------
def _pickles(content: bytes, limits: Limits) -> dict[str, Array]:
    if not content.startswith(b"\x80"):
        raise _FileError("it is no file that torch.save wrote" + (": it is empty" if not content else ""))
    stream = io.BytesIO(content)
    if read_pickle(stream) != _MAGIC:
        raise _FileError("it is a pickle, but not one that torch.save wrote")
    if read_pickle(stream) != _PROTOCOL:
        raise _FileError("it has an unknown version of the format of torch.save")
    system = read_pickle(stream)
    if not isinstance(system, dict) or system.get("little_endian") is not True:
        raise _FileError("its numbers are not said to be little-endian")
    kinds: dict[str, str] = {}
    tensors = named_tensors(read_pickle(stream, kinds), limits)
    keys = read_pickle(stream)
    if not isinstance(keys, list) or len(keys) > limits.arrays or not all(isinstance(key, (str, int)) for key in keys):
        raise _FileError("its list of storages is broken or too long", allowed=f"up to {limits.arrays}")
    storages = _storages(stream, len(content), [str(key)[:200] for key in keys], kinds)
    return arrays_of(tensors, storages, limits)


def _storages(stream: io.BytesIO, end: int, keys: Iterable[str], kinds: Mapping[str, str]) -> dict[str, bytes]:
    """The bytes of storages, each after the number of its numbers."""
    found = {}
    for key in keys:
        count = int.from_bytes(stream.read(8), "little")
        width = ITEM_BYTES.get(kinds.get(key, ""))
        if width is None:
            raise _FileError("a storage has an unknown type", clean(kinds.get(key, "none"), 60), ", ".join(ITEM_BYTES))
        left = end - stream.tell()
        if count * width > left:
            claimed = f"{count} numbers" if count < 2**62 else "a huge number"
            what = "a storage claims more numbers than the file has; it may be truncated"
            raise _FileError(what, claimed, f"{left} bytes")
        found[key] = stream.read(count * width)
    return found
