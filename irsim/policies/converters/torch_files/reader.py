"""Both formats that ``torch.save`` writes: ZIP archives since version 1.6, and pickles one after the other before."""

from __future__ import annotations

import io
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from irsim.common.archives import ContentError, opened_archive
from irsim.common.text import clean
from irsim.policies.converters.torch_files.pickles import read_pickle
from irsim.policies.converters.torch_files.tensors import ITEM_BYTES, arrays_of, named_tensors
from irsim.policies.networks.errors import LIMITS, Limits, PolicyFileError, content_flaw
from irsim.policies.networks.files import read_bytes
from irsim.policies.networks.values import Array

__all__ = ["parse_torch", "read_torch"]

_FIX = "save the weights with torch.save(model.state_dict(), FILE)"
_MAGIC, _PROTOCOL = 0x1950A86A20F9469CFC6C, 1001
"""First two objects of the old format."""


def read_torch(path: str | Path, limits: Limits = LIMITS) -> dict[str, Array]:
    """The tensors of a file that ``torch.save`` wrote, by name; no code of the file runs and torch is not needed.

    Args:
        path: The file: a state dictionary, a whole module, or a mapping that contains them.
        limits: How large it may be.

    Returns:
        Name -> array of float32. Names of modules inside others are joined by dots, as in a state dictionary.

    Raises:
        PolicyFileError: It is not such a file, it is over the limits, or a tensor cannot be used.
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
    except ContentError as error:
        raise PolicyFileError(clean(source), [content_flaw(error)], _FIX) from None


# the archive ----------------------------------------------------------------------------------------------------------
def _archive(content: bytes, limits: Limits) -> dict[str, Array]:
    with opened_archive(content, most_bytes=limits.unpacked_bytes, most_entries=limits.arrays + 16) as archive:
        names = frozenset(archive.namelist())
        root = _root(names)
        if f"{root}constants.pkl" in names:
            raise ContentError("it is a program of TorchScript, not weights")
        order = archive.read(f"{root}byteorder") if f"{root}byteorder" in names else b""
        if order.strip() not in (b"", b"little"):
            raise ContentError("its numbers are big-endian")
        tensors = named_tensors(read_pickle(io.BytesIO(archive.read(f"{root}data.pkl"))), limits)
        keys = {tensor.storage.key for tensor in tensors.values()}
        storages = {key: archive.read(f"{root}data/{key}") for key in keys if f"{root}data/{key}" in names}
    return arrays_of(tensors, storages, limits)


def _root(entries: Iterable[str]) -> str:
    """Folder of the archive that everything lies in, with its slash."""
    result = [name.removesuffix("data.pkl") for name in entries if name == "data.pkl" or name.endswith("/data.pkl")]
    if len(result) != 1:
        raise ContentError("it is an archive, but not one that torch.save wrote: it has no data.pkl")
    return result[0]


# pickles one after the other ------------------------------------------------------------------------------------------
def _pickles(content: bytes, limits: Limits) -> dict[str, Array]:
    if not content.startswith(b"\x80"):
        raise ContentError("it is not a file that torch.save wrote" + (": it is empty" if not content else ""))
    stream = io.BytesIO(content)
    if read_pickle(stream) != _MAGIC:
        raise ContentError("it is a pickle, but not one that torch.save wrote")
    if read_pickle(stream) != _PROTOCOL:
        raise ContentError("it has an unknown version of the format of torch.save")
    system = read_pickle(stream)
    if not isinstance(system, dict) or system.get("little_endian") is not True:
        raise ContentError("its numbers are not said to be little-endian")
    kinds: dict[str, str] = {}
    tensors = named_tensors(read_pickle(stream, kinds), limits)
    keys = read_pickle(stream)
    if not isinstance(keys, list) or len(keys) > limits.arrays or not all(map(_is_key, keys)):
        raise ContentError("its list of storages is broken or too long", allowed=f"up to {limits.arrays}")
    storages = _storages(stream, len(content), [str(key)[:200] for key in keys], kinds)
    return arrays_of(tensors, storages, limits)


def _is_key(key: Any) -> bool:
    return isinstance(key, str) or (isinstance(key, int) and 0 <= key < 2**63)  # longer ones have no decimal text


def _storages(stream: io.BytesIO, end: int, keys: Iterable[str], kinds: Mapping[str, str]) -> dict[str, bytes]:
    """The bytes of storages, each after the number of its numbers."""
    result = {}
    for key in keys:
        count = int.from_bytes(stream.read(8), "little")
        width = ITEM_BYTES.get(kinds.get(key, ""))
        if width is None:
            given = clean(kinds.get(key, "none"), 60)
            raise ContentError("a storage has an unknown type", given, ", ".join(ITEM_BYTES))
        left = end - stream.tell()
        if count * width > left:
            claimed = f"{count} numbers" if count < 2**62 else "a huge number"
            what = "a storage claims more numbers than the file has; it may be truncated"
            raise ContentError(what, claimed, f"{left} bytes")
        result[key] = stream.read(count * width)
    return result
