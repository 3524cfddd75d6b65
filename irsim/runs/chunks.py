"""A piece of a trace as a file: what changes in it row by row, what does not only once."""

from __future__ import annotations

import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from irsim.observers.trace import Trace
from irsim.runs.store import RunError

__all__ = ["Sensors", "load_chunk", "save_chunk"]

Sensors = Sequence[tuple[str, int]]
"""Key and number of beams of each sensor whose ranges are kept."""
_MOST_BYTES = 256 * 1024**2
_MOST_NUMBERS = 2**27
_BITS = {"arrived": 1, "collided": 2, "stopped": 4}


def save_chunk(file: IO[bytes], rows: Trace) -> None:
    """Write rows of a trace as NPZ.

    ``pose``, ``control`` and ``goal`` hold, for the objects of which anything changes in these rows (``…_of``), all
    rows, and the first row of everybody (``…_at``). ``flags``: 1 arrived, 2 collided, 4 stopped. ``ranges``: (T, beams
    of all sensors).
    """
    flags = sum(getattr(rows, name).astype(np.uint8) * np.uint8(bit) for name, bit in _BITS.items())
    arrays: dict[str, Any] = {"step": rows.step}
    for name, values in (("pose", rows.pose), ("control", rows.control), ("goal", rows.goal), ("flags", flags)):
        wide = np.asarray(values).reshape(len(rows), len(rows.names), -1)
        raw = np.ascontiguousarray(wide).view(np.uint8 if name == "flags" else np.int64)
        changing = np.flatnonzero((raw != raw[0]).any(axis=(0, 2))).astype(np.int32)
        arrays |= {name: wide[:, changing], f"{name}_of": changing, f"{name}_at": wide[0]}
    if rows.ranges:
        arrays["ranges"] = np.concatenate(list(rows.ranges.values()), axis=1)
    np.savez(file, **arrays)


def load_chunk(path: Path, names: tuple[str, ...], sensors: Sensors, step_time: float) -> Trace:
    """Read such a file.

    Args:
        path: The file.
        names: Names of the objects.
        sensors: Whose ranges it holds.
        step_time: Period [s].

    Raises:
        RunError: It is not what :func:`save_chunk` writes.
    """
    try:
        _check_size(path)
        with np.load(path, allow_pickle=False) as file:
            step = np.asarray(file["step"], dtype=np.int64)
            columns = {name: _whole(file, name, len(step), len(names)) for name in ("pose", "control", "goal", "flags")}
            ranges: dict[str, NDArray[np.float32]] = {}
            if sensors:
                cuts = np.cumsum([beams for _, beams in sensors])
                if file["ranges"].shape != (len(step), cuts[-1]):
                    raise ValueError("ranges of another shape")
                parts = np.split(np.asarray(file["ranges"], dtype=np.float32), cuts[:-1], axis=1)
                ranges = {key: part for (key, _), part in zip(sensors, parts, strict=True)}
    except (OSError, ValueError, KeyError, IndexError, TypeError, EOFError, zipfile.BadZipFile) as error:
        raise RunError("unreadable-run", f"'{path.name}' of run {path.parent.name} has been changed: {error}") from None
    flags = columns["flags"][:, :, 0].astype(np.uint8)
    return Trace(
        step=step,
        time=step.astype(np.float64) * step_time,
        pose=columns["pose"],
        control=columns["control"],
        goal=columns["goal"],
        arrived=(flags & _BITS["arrived"]).astype(bool),
        collided=(flags & _BITS["collided"]).astype(bool),
        stopped=(flags & _BITS["stopped"]).astype(bool),
        ranges=ranges,
        names=names,
        step_time=step_time,
    )


def _whole(file: Any, name: str, rows: int, objects: int) -> NDArray[Any]:
    """(T, N, K) of all objects from those that change and the first row of everybody."""
    first = file[f"{name}_at"]
    if first.ndim != 2 or len(first) != objects or first.shape[1] != (1 if name == "flags" else 3):
        raise ValueError(f"{name} of another shape")
    if rows * first.size > _MOST_NUMBERS:
        raise ValueError("more rows than are written")
    whole = np.repeat(first[None], rows, axis=0)
    whole[:, file[f"{name}_of"]] = file[name]
    return whole


def _check_size(path: Path) -> None:
    """Refuse files that would unpack to more than they are: these are never compressed."""
    with zipfile.ZipFile(path) as archive:
        entries = archive.infolist()
    if sum(entry.file_size for entry in entries) > min(_MOST_BYTES, path.stat().st_size):
        raise ValueError("compressed or too large")
