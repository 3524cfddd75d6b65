"""``parquet``: a table for pandas, DuckDB, Polars and Spark, with one row per step and object.

Its columns are ``run``, ``step``, ``time``, ``name``, ``role``, the pose ``x``, ``y``, ``theta``, the velocity ``vx``,
``vy``, ``yaw_rate``, ``speed``, the commanded controls ``control_0``, … (after
limits, before the noise of the drive), the present goal ``goal_x``, ``goal_y``,
``goal_theta``, ``goal_distance``, the flags ``arrived``, ``collided``, ``stopped`` and ``between_steps`` (it touched
something within the step, at neither end of it), a list of ranges ``ranges_0``, … for each lidar of an object, and
what its other sensors report: ``odometry.x``, ``imu.yaw_rate``, …, of a detector lists of all tracks.
Numbers that do not exist are null: velocities and controls at the start, goals of objects without one, controls that
only other drives have, scans that were not recorded.

Each field has the metadata ``unit`` and ``description``; the file has ``irsim`` (version that wrote it) and
``irsim.runs``, a JSON list with the scenario, seed, versions, step time, options, result and objects of each run.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from irsim.bridges.export.columns import Cells, Column, Ranges, Words, columns_of, table_parts
from irsim.bridges.export.episode import ExportedEpisode
from irsim.bridges.export.registry import Format
from irsim.common.installed import version

__all__ = ["FORMAT"]


def _write(episodes: Sequence[ExportedEpisode], target: Path, name: str) -> list[str]:
    """Write a row group for each part of the table, so that only one part is in memory."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    columns = columns_of(episodes)
    fields = [
        pa.field(
            column.name,
            _type(pa, column),
            metadata={"unit": column.unit, "description": column.meaning},
        )
        for column in columns
    ]
    runs = json.dumps([episode.facts for episode in episodes])
    schema = pa.schema(fields, metadata={"irsim": version(), "irsim.runs": runs})
    with pq.ParquetWriter(target, schema, compression="zstd") as writer:
        for episode in episodes:
            for cells in table_parts(episode, columns):
                arrays = [_array(pa, column, cells[column.name]) for column in columns]
                writer.write_batch(pa.record_batch(arrays, schema=schema))
    return []


def _type(pa: Any, column: Column) -> Any:
    """Type of a column in Arrow."""
    types = {
        "integer": pa.int64(),
        "number": pa.float64(),
        "flag": pa.bool_(),
        "word": pa.dictionary(pa.int32(), pa.string()),
        "ranges": pa.list_(pa.float32()),
    }
    return types[column.kind]


def _array(pa: Any, column: Column, cells: Cells) -> Any:
    """Cells as an Arrow array; NaN and missing scans are null."""
    if isinstance(cells, Words):
        return pa.DictionaryArray.from_arrays(cells.index, list(cells.words))
    if isinstance(cells, Ranges):
        missing = cells.lengths < 0
        offsets = np.concatenate([[0], np.cumsum(np.maximum(cells.lengths, 0))]).astype(np.int32)
        return pa.ListArray.from_arrays(pa.array(offsets), pa.array(cells.values), mask=pa.array(missing))
    if column.kind == "number":
        return pa.array(cells, mask=np.isnan(cells))
    return pa.array(cells)


FORMAT = Format("parquet", ".parquet", _write, libraries=("pyarrow",), several=True)
