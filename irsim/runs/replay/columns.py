"""Compact encoding of series of integers whose differences compress well, as the replay page reads them."""

from __future__ import annotations

import json
import zlib
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Columns", "changes", "quantised"]

Integers = NDArray[np.int32]
_MAX_INTEGER = 2**31 - 1
_COMPRESSION_LEVEL = 9


class Columns:
    """Named arrays of 32-bit integers and one head of plain data, as one block of bytes.

    Decompressed (zlib), a block is: length of the head (4 bytes, little endian); the head as JSON, whose ``columns``
    lists name, shape and order of each array; the arrays. An array is differenced ``order`` times along its last
    axis (in wrapping arithmetic, with zeros before the first value), its numbers are zigzag-encoded so that small ones
    of either sign have few bits, and first all lowest bytes are written, then all second bytes, and so on.
    """

    def __init__(self) -> None:
        self._list: list[dict[str, Any]] = []
        self._bytes: list[bytes] = []

    def add(self, name: str, values: Any, order: int = 0) -> None:
        """Add an array.

        Args:
            name: Name of the array in the page.
            values: Integers that fit into 32 bits, of any shape.
            order: Number of times that neighbours along the last axis are subtracted.

        Raises:
            OverflowError: A number does not fit.
        """
        wide = np.asarray(values, dtype=np.int64)
        if wide.size and not -(2**31) <= wide.min() <= wide.max() < 2**31:
            raise OverflowError(f"{name} does not fit into 32 bits")
        array = wide.astype(np.int32)
        self._list.append({"name": name, "shape": list(array.shape), "order": order})
        self._bytes.append(folded(array, order))

    def block(self, head: dict[str, Any]) -> bytes:
        """The compressed block."""
        text = json.dumps({**head, "columns": self._list}, separators=(",", ":"), allow_nan=False).encode()
        return zlib.compress(len(text).to_bytes(4, "little") + text + b"".join(self._bytes), _COMPRESSION_LEVEL)


def folded(array: Integers, order: int) -> bytes:
    """Bytes of one array, differenced ``order`` times and zigzag-encoded."""
    values = array.astype(np.int32)
    for _ in range(order):
        before = np.zeros((*values.shape[:-1], 1), dtype=np.int32)
        values = np.diff(values, axis=-1, prepend=before)
    numbers = ((values << 1) ^ (values >> 31)).astype("<i4")
    return numbers.reshape(-1, 1).view(np.uint8).T.tobytes()


def quantised(values: Any, quantum: float) -> Integers:
    """Values as whole multiples of ``quantum``; NaN becomes 0, and values beyond 32 bits the largest that fit."""
    quanta = np.asarray(values, dtype=np.float64) / quantum
    scaled = np.nan_to_num(quanta, nan=0.0, posinf=_MAX_INTEGER, neginf=-_MAX_INTEGER)
    return np.clip(np.rint(scaled), -_MAX_INTEGER, _MAX_INTEGER).astype(np.int32)


def changes(series: Sequence[NDArray[Any]]) -> tuple[Integers, Integers]:
    """Find the rows in which the values of each object change; the first row counts as a change.

    Args:
        series: Arrays (T, N); NaN equals NaN.

    Returns:
        Rows and objects of the changes, sorted by object, then by row.
    """
    changed = np.zeros(series[0].shape, dtype=bool)
    changed[0] = True
    for values in series:
        now, before = values[1:], values[:-1]
        same = now == before
        if values.dtype.kind == "f":
            same |= np.isnan(now) & np.isnan(before)
        changed[1:] |= ~same
    objects, rows = np.nonzero(changed.T)
    return rows.astype(np.int32), objects.astype(np.int32)
