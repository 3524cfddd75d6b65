"""From what a pickle describes to arrays with names, each checked before it is made."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from irsim.common.archives import ContentError
from irsim.common.text import clean
from irsim.policies.converters.torch_files.pickles import Storage, Stored, Tensor
from irsim.policies.networks.errors import Limits
from irsim.policies.networks.values import Array

__all__ = ["ITEM_BYTES", "arrays_of", "named_tensors"]

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
