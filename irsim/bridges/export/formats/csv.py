"""``csv``: the table of the format ``parquet`` as text, which needs no library; without metadata.

Numbers read back exactly, empty cells stand for missing values, and flags are 0 and 1. Ranges and tracks are
left out unless asked for; a scan is then one cell, its ranges separated by spaces. A name that a spreadsheet would run
as a formula, because it begins with ``=``, ``+``, ``-`` or ``@``, has an apostrophe before it.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from irsim.bridges.export.columns import Cells, Ranges, Words, columns_of, table_parts
from irsim.bridges.export.episode import ExportedEpisode
from irsim.bridges.export.registry import Format
from irsim.common.text import cell

__all__ = ["FORMAT"]


def _write(episodes: Sequence[ExportedEpisode], target: Path, name: str) -> list[str]:
    """Write one line for each row of the table."""
    columns = columns_of(episodes)
    with open(target, "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([cell(column.name) for column in columns])
        for episode in episodes:
            for cells in table_parts(episode, columns):
                writer.writerows(zip(*(_texts(cells[column.name]) for column in columns), strict=True))
    return []


def _texts(cells: Cells) -> list[str]:
    """Cells as text."""
    if isinstance(cells, Words):
        words = [cell(word) for word in cells.words]
        return [words[index] for index in cells.index.tolist()]
    if isinstance(cells, Ranges):
        texts, begin = [], 0
        for length in cells.lengths.tolist():
            scan = cells.values[begin : begin + max(0, length)]
            begin += len(scan)
            texts.append(" ".join(map(str, scan.tolist())))
        return texts
    if cells.dtype == np.bool_:
        return ["1" if value else "0" for value in cells.tolist()]
    return ["" if value != value else repr(value) for value in cells.tolist()]


FORMAT = Format("csv", ".csv", _write, several=True, ranges=False)
