"""Reports of sensors without beams in a recorded run, as columns of tables: ``odometry.x``, ``imu.yaw_rate``."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irsim.runs.tables import Cell, rounded
from irsim.simulation.trace import Trace

__all__ = ["NOT_RECORDED", "reading_cell", "reading_columns"]

NOT_RECORDED = "not recorded"


def reading_columns(trace: Trace, objects: Sequence[int]) -> list[str]:
    """``<sensor>.<number>`` of all sensors of some objects, each once."""
    owners = {trace.names[index] for index in objects}
    columns: dict[str, None] = {}
    for key, block in trace.readings.items():
        owner, _, sensor = key.rpartition("/")
        if owner in owners:
            columns.update(dict.fromkeys(f"{sensor}.{name}" for name in block.dtype.names or ()))
    return list(columns)


def reading_cell(trace: Trace, column: str, row: int, index: int) -> Cell:
    """A number of a sensor; of one that reports rows, the numbers of all rows that have any, separated by spaces.

    It is None for an object without the sensor, and for a number that is missing.
    """
    sensor, _, name = column.partition(".")
    block = trace.readings.get(f"{trace.names[index]}/{sensor}")
    if block is None or name not in (block.dtype.names or ()):
        return None
    if row >= len(block):
        return NOT_RECORDED
    if block.ndim == 1:
        return rounded(float(block[name][row]))
    values = block[name][row]
    return " ".join(f"{rounded(value):g}" for value in values[np.isfinite(values)].tolist())
