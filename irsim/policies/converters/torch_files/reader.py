"""Both formats that ``torch.save`` writes: ZIP archives since version 1.6, and pickles one after the other before.

The objects of a pickle become arrays with names, each checked before it is made.
"""

from __future__ import annotations

import io
import math
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from irsim.common.archives import opened_archive
from irsim.common.records import ContentError
from irsim.common.text import clean
from irsim.policies.converters.torch_files.pickles import Storage, Stored, Tensor, read_pickle
from irsim.policies.networks.errors import LIMITS, Limits, PolicyFileError, content_flaw
from irsim.policies.networks.files import file_bytes
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
    return parse_torch(file_bytes(Path(path), limits.file_bytes, "a file that torch.save wrote"), str(path), limits)


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


_FLOATS = {"FloatStorage": "<f4", "DoubleStorage": "<f8", "HalfStorage": "<f2", "BFloat16Storage": "<u2"}
_BRAIN = "BFloat16Storage"
"""Numbers of 16 bits that are the upper halves of float32."""
ITEM_BYTES = {
    "FloatStorage": 4, "DoubleStorage": 8, "HalfStorage": 2, "BFloat16Storage": 2, "LongStorage": 8, "IntStorage": 4,
    "ShortStorage": 2, "CharStorage": 1, "ByteStorage": 1, "BoolStorage": 1, "ComplexFloatStorage": 8,
    "ComplexDoubleStorage": 16,
}  # fmt: skip
"""Size of a number of each type of storage [bytes]."""
_MAX_DEPTH = 40
_MAX_PLACES = 50_000
_MAX_SIDES = 8
_PARTS = ("_parameters", "_buffers", "_modules")
"""Attributes of a module that hold what its state dictionary has."""


def named_tensors(root: Any, limits: Limits) -> dict[str, Tensor]:
    """The tensors of an object by the names that the state dictionary of a module gives them.

    Dictionaries, lists and objects of foreign classes are searched; keys and attributes are joined by dots.

    Raises:
        ContentError: There are no tensors or too many, they are nested too deeply, or two have the same name.
    """
    result: dict[str, Tensor] = {}
    waiting: list[tuple[str, Any, int]] = [("", root, 0)]
    places = 0
    while waiting:
        name, value, depth = waiting.pop()
        places += 1
        if places + len(waiting) > _MAX_PLACES or depth > _MAX_DEPTH:
            raise ContentError("the object is nested too deeply or refers to itself", place=name)
        if isinstance(value, Tensor):
            if name in result:
                raise ContentError("two tensors have the same name", place=name)
            result[name] = value
            if len(result) > limits.arrays:
                raise ContentError("too many tensors", f"more than {limits.arrays}", f"up to {limits.arrays}")
        else:
            inside = [(f"{name}.{key}" if name else key, one, depth + 1) for key, one in _children(value)]
            waiting += reversed(inside)
    if not result:
        raise ContentError("there are no tensors in it")
    return result


def _children(value: Any) -> Iterator[tuple[str, Any]]:
    """Parts of a value that may hold tensors, with their names there."""
    if isinstance(value, Stored):
        state = value.state
        if isinstance(state, tuple):  # attributes and slots
            state = next((one for one in state if isinstance(one, dict)), None)
        if isinstance(state, dict) and any(part in state for part in _PARTS):
            for part in _PARTS:
                yield from _items(state.get(part))
        else:
            yield from _items(state)
        yield from _items(value.entries)
    elif isinstance(value, (list, tuple)):
        yield from ((str(index), one) for index, one in enumerate(value) if _may_hold(one))
    else:
        yield from _items(value)


def _items(value: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        for key, one in value.items():
            if isinstance(key, (str, int)) and _may_hold(one):
                text = key if isinstance(key, str) else str(key) if abs(key) < 2**63 else "number"
                yield text[:100], one


def _may_hold(value: Any) -> bool:
    return isinstance(value, (Tensor, Stored, dict, list, tuple))


def arrays_of(tensors: Mapping[str, Tensor], content: Mapping[str, bytes], limits: Limits) -> dict[str, Array]:
    """The numbers of tensors as arrays of float32.

    Args:
        tensors: The tensors by name.
        content: Key of a storage -> its bytes.
        limits: How many numbers there may be.

    Raises:
        ContentError: One has another type, does not fit its storage, or has numbers that are not finite.
    """
    total = 0
    result = {}
    for name, tensor in tensors.items():
        total += _checked_count(name, tensor, limits)
        if total > limits.parameters:
            raise ContentError("too many numbers in all tensors", str(total), f"up to {limits.parameters}", place=name)
        result[name] = _array(name, tensor, content)
    return result


def _checked_count(name: str, tensor: Tensor, limits: Limits) -> int:
    """How many numbers a tensor has; its size, steps and first number are small whole numbers afterwards."""
    size, stride, offset = tensor.size, tensor.stride, tensor.offset
    fits = isinstance(size, tuple) and isinstance(stride, tuple) and len(size) == len(stride) <= _MAX_SIDES
    if not fits or not all(type(side) is int and side >= 0 for side in (*size, *stride, offset)):
        raise ContentError("its shape is not one of whole numbers", place=name)
    if any(side > limits.parameters for side in size) or math.prod(size) > limits.parameters:
        raise ContentError("the tensor is too large", _sides(size), f"up to {limits.parameters} numbers", place=name)
    count: int = math.prod(size)
    last = offset + sum((side - 1) * step for side, step in zip(size, stride, strict=True)) if count else -1
    if last >= tensor.storage.count:
        most = f"{tensor.storage.count} numbers"
        raise ContentError("the tensor is larger than its storage", _sides(size), most, place=name)
    return count


def _array(name: str, tensor: Tensor, content: Mapping[str, bytes]) -> Array:
    storage = tensor.storage
    if storage.kind not in _FLOATS:
        kind, known = clean(storage.kind, 60), ", ".join(_FLOATS)
        raise ContentError("weights are floating-point numbers", kind, known, place=name)
    numbers = _numbers(name, storage, content.get(storage.key))
    strides = [step * numbers.itemsize for step in tensor.stride]
    first = numbers[tensor.offset :] if math.prod(tensor.size) else numbers[:0]
    array = np.lib.stride_tricks.as_strided(first, tensor.size, strides, writeable=False)
    if storage.kind == _BRAIN:
        array = (array.astype(np.uint32) << np.uint32(16)).view(np.float32)
    with np.errstate(over="ignore", invalid="ignore"):
        made = np.array(array, dtype=np.float32, order="C")
    if not np.isfinite(made).all():
        raise ContentError("the tensor has numbers that are not finite in float32", place=name)
    return made


def _numbers(name: str, storage: Storage, raw: bytes | None) -> Array:
    if raw is None:
        raise ContentError("the file has no numbers for the tensor", clean(storage.key, 60), place=name)
    numbers = np.frombuffer(raw[: len(raw) // ITEM_BYTES[storage.kind] * ITEM_BYTES[storage.kind]],
                            dtype=_FLOATS[storage.kind])  # fmt: skip
    if storage.offset + storage.count > len(numbers):
        claimed = str(storage.offset + storage.count)
        raise ContentError("the file has fewer numbers than it claims", f"{len(numbers)} numbers", claimed, place=name)
    return numbers[storage.offset : storage.offset + storage.count]


def _sides(size: tuple[int, ...]) -> str:
    return " x ".join(str(side) if side < 2**63 else "a huge number" for side in size) or "one number"
