"""Recorded runs as a table of pandas, with the columns of the format ``parquet``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from irsim.bridges.export.columns import Cells, Ranges, Words, columns_of, table_parts
from irsim.bridges.export.episode import open_episode
from irsim.common.extras import library
from irsim.runs.reading import Run

__all__ = ["run_frame"]


def run_frame(runs: Sequence[Run], objects: str | Sequence[str] = "movers", *, ranges: bool = False) -> Any:
    """The table of some runs, one row per step and object; ``attrs["units"]`` has the unit of each column.

    Args:
        runs: The runs, one after the other in the table.
        objects: Which objects, as for :func:`irsim.export_run`.
        ranges: Whether the table has the ranges of lidars.

    Raises:
        ExtraError: pandas is missing.
        RunError: A run has no such object, or cannot be read.
    """
    pandas = library("pandas")
    episodes = [open_episode(run, objects, with_ranges=ranges) for run in runs]
    columns = columns_of(episodes)
    parts = [cells for episode in episodes for cells in table_parts(episode, columns)]
    table = {}
    for column in columns:
        own = [part[column.name] for part in parts]
        cells = np.concatenate([_plain(one) for one in own])
        words = dict.fromkeys(word for one in own if isinstance(one, Words) for word in one.words)
        table[column.name] = pandas.Categorical(cells, categories=list(words)) if column.kind == "word" else cells
    frame = pandas.DataFrame(table)
    frame.attrs["units"] = {column.name: column.unit for column in columns}
    return frame


def _plain(cells: Cells) -> Any:
    """Cells as an array: words as text, scans as arrays, None for a scan that does not exist."""
    if isinstance(cells, Words):
        return np.array(cells.words, dtype=object)[cells.index]
    if not isinstance(cells, Ranges):
        return cells
    scans, begin = np.full(len(cells.lengths), None, dtype=object), 0
    for row, length in enumerate(cells.lengths.tolist()):
        if length >= 0:
            scans[row] = cells.values[begin : begin + length]
            begin += length
    return scans
