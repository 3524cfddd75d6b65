"""A piece of a trace as a file: NPZ, not compressed, with what changes row by row and what does not only once."""

from __future__ import annotations

import json
import zipfile
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from struct import Struct
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from irsim import _core as core
from irsim.observers.trace import Trace
from irsim.runs.store import RunError

__all__ = ["Layout", "load_chunk", "load_events", "save_chunk"]

_MOST_BYTES = 256 * 1024**2
_MOST_NUMBERS = 2**27
_EVENTS = "events.json"
_BITS = {"arrived": 1, "collided": 2, "stopped": 4}
_ENTRY, _MADE_BY, _PLACE, _END = (Struct(f"<{kind}") for kind in ("5H3I2H", "H", "3H2I", "4H2IH"))
_VERSION, _EPOCH = 20, 33  # that can read it; the 1st of January 1980, as ZIP counts


@dataclass(frozen=True)
class Layout:
    """What the pieces of one run have in common.

    Attributes:
        names: Names of the N objects.
        sensors: Key and number of beams of each sensor whose ranges are kept.
        step_time: Period [s].
    """

    names: tuple[str, ...]
    sensors: Sequence[tuple[str, int]]
    step_time: float


def save_chunk(
    file: IO[bytes], log: core.Log, movers: NDArray[np.int32], pose: NDArray[np.float64], events: bytes
) -> None:
    """Write what a log holds.

    ``steps``: the first one and how many. ``pose`` (T, M, 3) and, in single precision, ``control`` (T, M, C) of the
    objects ``movers``; ``pose_at`` (N, 3) of everybody. ``goal`` (K, N, 3), ``flags`` (K, N; 1 arrived, 2 collided, 4
    stopped) and ``ranges`` (K, beams) hold from the rows ``goal_rows``, ``flag_rows`` and ``scan_rows`` on; without any
    row of scans none were kept. What happened lies beside the arrays as ``events.json``.

    Args:
        file: Where to.
        log: What happened since the last piece.
        movers: Objects whose poses it holds.
        pose: (N, 3) present pose of everybody.
        events: What happened, as JSON.
    """
    arrays: dict[str, NDArray[Any]] = {
        "steps": np.array([log.first, log.rows], dtype=np.int64),
        "movers": movers,
        "pose_at": pose,
        "pose": log.pose,
        "control": log.control,
        "goal_rows": log.goal_rows,
        "goal": log.goal,
        "flag_rows": log.flag_rows,
        "flags": log.flags,
        "scan_rows": log.scan_rows,
        "ranges": log.ranges,
    }
    entries = [
        (f"{name}.npy", _head(array), array.data.cast("B") if array.size else b"") for name, array in arrays.items()
    ]
    _write_archive(file, [*entries, (_EVENTS, b"", events)])


def _write_archive(file: IO[bytes], entries: Sequence[tuple[str, bytes, bytes | memoryview]]) -> None:
    """A ZIP archive of entries that are not compressed: a name, and the two parts of what it holds.

    :mod:`zipfile` takes six times as long, more than the steps of a short run. PKWARE's APPNOTE 6.3, sections 4.3.7
    (before each entry), 4.3.12 (directory) and 4.3.16 (its end).
    """
    directory, place = [], 0
    for name, head, body in entries:
        size = len(head) + len(body)
        known = _ENTRY.pack(_VERSION, 0, 0, 0, _EPOCH, zlib.crc32(body, zlib.crc32(head)), size, size, len(name), 0)
        file.writelines((b"PK\x03\x04", known, name.encode(), head, body))
        directory.append(
            b"PK\x01\x02" + _MADE_BY.pack(_VERSION) + known + _PLACE.pack(0, 0, 0, 0, place) + name.encode()
        )
        place += 4 + _ENTRY.size + len(name) + size
    told = b"".join(directory)
    file.write(told + b"PK\x05\x06" + _END.pack(0, 0, len(entries), len(entries), len(told), place, 0))


def _head(array: NDArray[Any]) -> bytes:
    """Of a file in NPY format 1.0; the data begin at a multiple of 64 bytes."""
    text = f"{{'descr': {array.dtype.str!r}, 'fortran_order': False, 'shape': {array.shape}, }}"
    text += " " * (-(len(text) + 11) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text.encode()


def load_chunk(path: Path, layout: Layout) -> Trace:
    """Read such a file.

    Raises:
        RunError: It is not what :func:`save_chunk` writes.
    """
    with _changes(path):
        _check_size(path)
        with np.load(path, allow_pickle=False) as file:
            return _trace({name: file[name] for name in file.files}, layout)


def load_events(path: Path) -> Any:
    """Read what happened from such a file, as :func:`save_chunk` was given it.

    Raises:
        RunError: It is not what :func:`save_chunk` writes.
    """
    with _changes(path):
        _check_size(path)
        with zipfile.ZipFile(path) as archive:
            return json.loads(archive.read(_EVENTS))


@contextmanager
def _changes(path: Path) -> Iterator[None]:
    """Whatever is wrong with a file, in our words."""
    try:
        yield
    except (
        OSError,
        ValueError,
        KeyError,
        IndexError,
        TypeError,
        EOFError,
        NotImplementedError,
        zipfile.BadZipFile,
    ) as error:
        raise RunError("unreadable-run", f"'{path.name}' of run {path.parent.name} has been changed: {error}") from None


def _trace(arrays: dict[str, NDArray[Any]], layout: Layout) -> Trace:
    first, rows = (int(value) for value in arrays["steps"])
    count, beams = len(layout.names), sum(number for _, number in layout.sensors)
    if first < 0 or not 0 < rows * max(1, count * 3, beams) <= _MOST_NUMBERS:
        raise ValueError("more rows than are written")
    movers, columns = arrays["movers"], arrays["control"].shape[-1]
    _expect(arrays["pose_at"], (count, 3))
    _expect(arrays["pose"], (rows, len(movers), 3))
    _expect(arrays["control"], (rows, len(movers), columns))
    pose = np.repeat(arrays["pose_at"][None], rows, axis=0)
    pose[:, movers] = arrays["pose"]
    control = np.zeros((rows, count, 3))
    control[:, movers, :columns] = arrays["control"]
    flags = _held(arrays, "flag_rows", "flags", rows, (count,)).astype(np.uint8)
    ranges: dict[str, NDArray[np.float32]] = {}
    if layout.sensors:
        scans = np.zeros((0, beams), dtype=np.float32)
        if len(arrays["scan_rows"]):
            scans = _held(arrays, "scan_rows", "ranges", rows, (beams,)).astype(np.float32, copy=False)
        cuts = np.cumsum([number for _, number in layout.sensors])[:-1]
        ranges = {key: part for (key, _), part in zip(layout.sensors, np.split(scans, cuts, axis=1), strict=True)}
    step = np.arange(first, first + rows, dtype=np.int64)
    return Trace(
        step=step,
        time=step.astype(np.float64) * layout.step_time,
        pose=pose,
        control=control,
        goal=_held(arrays, "goal_rows", "goal", rows, (count, 3)),
        arrived=(flags & _BITS["arrived"]).astype(bool),
        collided=(flags & _BITS["collided"]).astype(bool),
        stopped=(flags & _BITS["stopped"]).astype(bool),
        ranges=ranges,
        names=layout.names,
        step_time=layout.step_time,
    )


def _held(
    arrays: dict[str, NDArray[Any]], rows_name: str, name: str, rows: int, shape: tuple[int, ...]
) -> NDArray[Any]:
    """(T, …) of values that each hold from their row on."""
    begins, values = arrays[rows_name], arrays[name]
    _expect(values, (len(begins), *shape))
    if not values.size:
        return np.zeros((rows, *shape), dtype=values.dtype)
    if begins[0] != 0 or (np.diff(begins) <= 0).any() or begins[-1] >= rows:
        raise ValueError(f"{rows_name} out of order")
    return np.repeat(values, np.diff([*begins, rows]), axis=0)


def _expect(array: NDArray[Any], shape: tuple[int, ...]) -> None:
    if array.shape != shape:
        raise ValueError(f"an array of shape {array.shape} where {shape} is written")


def _check_size(path: Path) -> None:
    """Refuse files that would unpack to more than they are: these are never compressed."""
    with zipfile.ZipFile(path) as archive:
        entries = archive.infolist()
    if sum(entry.file_size for entry in entries) > min(_MOST_BYTES, path.stat().st_size):
        raise ValueError("compressed or too large")
