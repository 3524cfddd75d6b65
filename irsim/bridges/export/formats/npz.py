"""``npz``: arrays by name for NumPy, with one row per step and one column per object.

The arrays are ``step`` and ``time`` (T,), ``pose``, ``velocity``, ``control`` and ``goal`` (T, N, 3), the flags
``arrived``, ``collided``, ``stopped`` and ``between_steps`` (T, N), which says whether an object touched something
within the step and at neither end of it, ``command`` (T, N, 3) if an object has ``actuation``,
``ranges/<object>/<number>`` (T, beams), ``readings/<object>/<sensor>``, structured arrays (T,), of a detector (T, K),
whose fields are the numbers that the sensor reports by name, ``names`` and ``roles`` (N,), and
``about``, a JSON text with the units, and with the scenario, seed, versions, result and objects of the run.
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from irsim.bridges.export.episode import Block, ExportedEpisode
from irsim.bridges.export.registry import Format

__all__ = ["FORMAT"]

_UNITS = {
    "time": "s",
    "pose": "m, m, rad: x, y, heading in the world frame",
    "velocity": "m/s, m/s, rad/s: mean over the step that led to the row, world frame; NaN in row 0",
    "control": "units of the drive: executed in the step that led to the row, before noise of the drive, zero padded",
    "command": "units of the drive: commanded in that step; NaN for objects without actuation",
    "goal": "m, m, rad: x, y, heading in the world frame; NaN without a goal",
    "ranges": "m, from right to left; infinite: nothing was hit",
}
_TRACE: Mapping[str, Callable[[Block], NDArray[Any]]] = {
    "step": lambda block: block.trace.step,
    "time": lambda block: block.trace.time,
    "pose": lambda block: block.trace.pose,
    "velocity": lambda block: block.velocity,
    "control": lambda block: block.trace.control,
    "goal": lambda block: block.trace.goal,
    "arrived": lambda block: block.trace.arrived,
    "collided": lambda block: block.trace.collided,
    "stopped": lambda block: block.trace.stopped,
    "between_steps": lambda block: block.between_steps,
}


def _write(episodes: Sequence[ExportedEpisode], target: Path, name: str) -> list[str]:
    """Write one array after the other; the run is read once for each, so that it need not fit in memory."""
    [episode] = episodes
    units = {f"readings/{gauge.key}": dict(gauge.units) for gauge in episode.gauges}
    about = {"units": {**_UNITS, **units}, "run": episode.facts}
    whole = {
        "names": np.array([actor.name for actor in episode.actors]),
        "roles": np.array([actor.role for actor in episode.actors]),
        "about": np.array(json.dumps(about)),
    }
    rows = episode.last_step + 1
    with zipfile.ZipFile(target, "w") as archive:
        for name, values in whole.items():
            _add(archive, name, None, iter([values]))
        for name, part in _TRACE.items():
            _add(archive, name, rows, (part(block) for block in episode.blocks(scans=False)))
        if next(episode.blocks(scans=False)).trace.command is not None:
            _add(archive, "command", rows, (_command(block) for block in episode.blocks(scans=False)))
        for lidar in episode.lidars:
            scans = (block.trace.ranges[lidar.key] for block in episode.blocks())
            _add(archive, f"ranges/{lidar.key}", episode.last_scan + 1, scans)
        for gauge in episode.gauges:
            readings = (block.trace.readings[gauge.key] for block in episode.blocks())
            _add(archive, f"readings/{gauge.key}", episode.last_scan + 1, readings)
    return []


def _command(block: Block) -> NDArray[np.float64]:
    """The commands of a run in which objects have actuation."""
    assert block.trace.command is not None
    return block.trace.command


def _add(archive: zipfile.ZipFile, name: str, rows: int | None, parts: Iterator[NDArray[Any]]) -> None:
    """Add an array with a number of rows, of which each part has some; None: the first part is the whole array."""
    first = next(parts)
    shape = first.shape if rows is None else (rows, *first.shape[1:])
    header = {"descr": npy.dtype_to_descr(first.dtype), "fortran_order": False, "shape": shape}
    with archive.open(f"{name}.npy", "w", force_zip64=True) as file:
        npy.write_array_header_1_0(file, header)
        file.write(first.tobytes())
        for values in parts:
            file.write(values.tobytes())


FORMAT = Format("npz", ".npz", _write)
