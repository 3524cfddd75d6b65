"""The occupied cells of a map in a recorded run: one bit each, in an NPZ file that needs nothing else of irsim."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.archives import pack_arrays, unpack_arrays
from irsim.common.arrays import Floats
from irsim.common.records import ContentError

__all__ = ["CELLS_FILE", "pack_cells", "unpack_cells"]

CELLS_FILE = "cells.npz"
_MAX_BYTES = 80_000_000
"""Size of the largest file that is read."""
_MAX_CELLS = 2**29
"""Number of cells of the largest map that is read."""


def pack_cells(occupied: NDArray[np.uint8], origin: Sequence[float], cell: Sequence[float]) -> bytes:
    """The content of the file.

    Args:
        occupied: (nx, ny) non-zero where occupied, i along +x, j along +y.
        origin: Lower left corner of the map, world frame [m].
        cell: Extent of a cell along x and y [m].
    """
    arrays: dict[str, NDArray[Any]] = {
        "bits": np.packbits(occupied != 0),
        "shape": np.array(occupied.shape, dtype=np.int64),
        "origin": np.array(origin, dtype=np.float64),
        "cell": np.array(cell, dtype=np.float64),
    }
    return pack_arrays(arrays)


def unpack_cells(content: bytes) -> tuple[NDArray[np.bool_], Floats, Floats]:
    """The occupied cells (nx, ny), the lower left corner (2,) and the extent of a cell (2,) of :func:`pack_cells`.

    Raises:
        ContentError: The content is something else.
    """
    arrays = unpack_arrays(content, ("u1", "i8", "f8"), most_bytes=_MAX_BYTES, most_arrays=4)
    try:
        bits, shape, origin, cell = (arrays[name] for name in ("bits", "shape", "origin", "cell"))
    except KeyError as error:
        raise ContentError(f"it has no array {error}") from None
    fits = shape.shape == origin.shape == cell.shape == (2,) and bits.ndim == 1 and shape.dtype.kind == "i"
    if (
        not fits
        or not (shape > 0).all()
        or not (shape <= _MAX_CELLS).all()
        or int(shape[0]) * int(shape[1]) > _MAX_CELLS
    ):
        raise ContentError("its arrays have other shapes than a map")
    count = int(shape[0]) * int(shape[1])
    if bits.dtype != np.uint8 or len(bits) != -(-count // 8):
        raise ContentError("its bits do not fit its shape")
    if not (np.isfinite(origin).all() and np.isfinite(cell).all() and (cell > 0).all()):
        raise ContentError("its corner or cells are impossible")
    return np.unpackbits(bits, count=count).reshape(int(shape[0]), int(shape[1])).astype(bool), origin, cell
