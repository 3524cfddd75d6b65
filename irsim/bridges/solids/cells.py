"""Solid cells of a map, merged into few rectangles."""

from __future__ import annotations

import numpy as np

from irsim.common.arrays import Floats
from irsim.simulation.scene import Grid

__all__ = ["merged_cells"]


def merged_cells(grid: Grid) -> Floats:
    """(K, 4) rectangles x0, y0, x1, y1 [m], world frame, that cover the solid cells of a map and do not overlap.

    Runs of cells along x that are the same in successive rows become one rectangle.
    """
    solid = np.asarray(grid.occupied, dtype=bool)
    done: list[tuple[int, int, int, int]] = []
    open_: dict[tuple[int, int], int] = {}  # run of columns -> the row in which its rectangle begins
    for row in range(solid.shape[1]):
        runs = _runs(solid[:, row])
        kept = {run: open_.pop(run) for run in runs if run in open_}
        done.extend((begin, first, end, row) for (begin, end), first in open_.items())
        open_ = {run: kept.get(run, row) for run in runs}
    done.extend((begin, first, end, solid.shape[1]) for (begin, end), first in open_.items())
    cells = np.array(done, dtype=np.float64).reshape(-1, 2, 2)
    found: Floats = (cells * np.array(grid.cell) + np.array(grid.origin)).reshape(-1, 4)
    return found


def _runs(cells: np.ndarray) -> list[tuple[int, int]]:
    """Begin and end of each run of solid cells."""
    change = np.flatnonzero(np.diff(np.concatenate([[False], cells, [False]]).astype(np.int8)))
    return [(int(begin), int(end)) for begin, end in change.reshape(-1, 2)]
