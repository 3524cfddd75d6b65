"""Arrays in memory that several processes share. It has no name in the file system and vanishes with the processes."""

from __future__ import annotations

import math
import mmap
import os
import sys
import tempfile
import uuid
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["ArrayLayout", "SharedMemory"]

_ALIGNMENT = 64
"""Arrays begin at multiples of it: the size of a line of the processor's cache [bytes]."""


@dataclass(frozen=True)
class ArrayLayout:
    """An array that is shared.

    Attributes:
        name: Its name.
        shape: Its shape.
        dtype: Its type, as NumPy writes it.
        axis: Axis along which it is divided among worlds or slots.
    """

    name: str
    shape: tuple[int, ...]
    dtype: str
    axis: int = 0

    @property
    def size(self) -> int:
        """Bytes with those up to the next array."""
        exact = math.prod(self.shape) * np.dtype(self.dtype).itemsize
        return -(-max(exact, 1) // _ALIGNMENT) * _ALIGNMENT


class SharedMemory:
    """Memory that processes share, which begins empty.

    Args:
        key: The :attr:`key` in the process that made it; None makes new memory.

    Attributes:
        key: Key for another process: the number of an inherited file, or on Windows a name.
    """

    def __init__(self, key: int | str | None = None) -> None:
        self.key = _new() if key is None else key

    @property
    def inherited(self) -> tuple[int, ...]:
        """Files that another process has to inherit."""
        return (self.key,) if isinstance(self.key, int) else ()

    def arrays(self, layout: Sequence[ArrayLayout]) -> dict[str, NDArray[Any]]:
        """The arrays of a layout, by name; zeros in new memory."""
        size = sum(one.size for one in layout)
        memory = self._map(size)
        arrays, start = {}, 0
        for one in layout:
            arrays[one.name] = np.ndarray(one.shape, one.dtype, memory, start)
            start += one.size
        return arrays

    def _map(self, size: int) -> mmap.mmap:
        if sys.platform == "win32":
            return mmap.mmap(-1, size, tagname=str(self.key))
        file = int(self.key)
        if os.fstat(file).st_size < size:
            os.ftruncate(file, size)
        return mmap.mmap(file, size)

    def close(self) -> None:
        """Close the file; arrays and other processes keep the memory."""
        if isinstance(self.key, int):
            os.close(self.key)
            self.key = ""


def _new() -> int | str:
    if sys.platform == "win32":
        return f"irsim-{uuid.uuid4().hex}"
    if sys.platform == "linux":
        return os.memfd_create("irsim")
    with tempfile.TemporaryFile() as file:  # no other process finds it by a name
        return os.dup(file.fileno())
