"""A piece of a recorded run as an uncompressed NPZ file, in which values that rarely change are stored once per change.

Poses and controls have one row per step; goals, flags, scans and readings only the rows in which they change.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from struct import Struct
from threading import Lock, Thread
from typing import Any
from zipfile import ZipFile

import numpy as np
from isal.isal_zlib import crc32
from numpy.typing import NDArray
from pydantic_core import to_json

import irsim._core as core
from irsim.common.archives import opened_archive, read_array
from irsim.common.files import Buffer
from irsim.common.records import ContentError, read_json
from irsim.runs.files import unreadable
from irsim.simulation.trace import Trace, by_name

__all__ = ["Layout", "PieceWriter", "load_chunk", "load_events", "pack_chunk"]


_MAX_BYTES = 256 * 1024**2
"""Size of the largest piece that is read."""
_MAX_NUMBERS = 2**27
"""Number of values of the largest array that is read."""
_MAX_LENGTH_M = 1e12
"""Largest coordinate, speed and range that is read [m, m/s, rad]; squares of it are numbers, too."""
_MAX_ENTRIES = 16
_KINDS = ("f8", "f4", "u1")
_ABOUT = "piece.json"
_ARRAYS = ("pose", "control", "pose_at", "goal", "flags")
_BITS = {"arrived": 1, "collided": 2, "stopped": 4}
_ENTRY, _PLACE, _END = (Struct(f"<{kind}") for kind in ("5H3I2H", "3H2I", "4H2IH"))
_MADE_BY = b"\x14\x00"
_VERSION = 20
"""ZIP version needed to read the archive."""
_EPOCH = 33
"""Date of all entries in ZIP format: 1 January 1980."""


@dataclass(frozen=True)
class Layout:
    """Properties that all pieces of one run share.

    Attributes:
        names: Names of the N objects.
        sensors: Key and number of beams of each sensor whose ranges are recorded.
        step_time: Period [s].
        gauges: Key, names of a row of numbers, and how many numbers there are, of each sensor that reports numbers.
    """

    names: tuple[str, ...]
    sensors: Sequence[tuple[str, int]]
    step_time: float
    gauges: Sequence[tuple[str, Sequence[str], int]] = ()


def pack_chunk(
    log: core.Log, movers: Sequence[int], pose: NDArray[np.float64], events: Sequence[Mapping[str, Any]]
) -> list[Buffer]:
    """The content of a log as the parts of a file, which are valid until the log changes.

    The arrays are ``pose`` (T, M, 3) and, in single precision, ``control`` (T, M, C) of the objects that can move;
    ``pose_at`` (N, 3) of all objects; ``goal`` (K, N, 3), ``flags`` (K, N; 1 arrived, 2 collided, 4 stopped) and
    ``ranges`` (K, beams) with one row per change. ``piece.json`` has the ``first`` step and number of ``rows``, the
    indices of the ``movers``, the rows from which on each goal, flag and scan holds (``goal_rows``, ``flag_rows``,
    ``scan_rows``, empty without scans), and the ``events``. If some of the movers have actuators, their commands are
    in ``command`` (T, number of them, C), and ``piece.json`` has their indices (``commanded``). The numbers of sensors
    without beams are in ``readings`` (K, number of them), with one row per change (``reading_rows``).

    Args:
        log: The trace since the last piece.
        movers: Indices of the objects whose poses the log has.
        pose: (N, 3) present poses of all objects.
        events: Events since the last piece.
    """
    about: dict[str, Any] = {
        "first": log.first,
        "rows": log.rows,
        "movers": movers,
        "goal_rows": log.goal_rows.tolist(),
        "flag_rows": log.flag_rows.tolist(),
        "scan_rows": log.scan_rows.tolist(),
        "events": events,
    }
    arrays: dict[str, NDArray[Any]] = {
        "pose": log.pose,
        "control": log.control,
        "pose_at": pose,
        "goal": log.goal,
        "flags": log.flags,
        "ranges": log.ranges,
    }
    if log.commanded:
        about["commanded"], arrays["command"] = log.commanded, log.command
    if log.readings.size:
        about["reading_rows"], arrays["readings"] = log.reading_rows.tolist(), log.readings
    entries = [
        (f"{name}.npy", _head(array), array.data.cast("B") if array.size else b"") for name, array in arrays.items()
    ]
    return _archive([(_ABOUT, b"", to_json(about)), *entries])


def _archive(entries: Sequence[tuple[str, bytes, Buffer]]) -> list[Buffer]:
    """A ZIP archive of uncompressed entries, each given by its name and the two parts of its content.

    :mod:`zipfile` takes six times as long, longer than a short run. See PKWARE's APPNOTE 6.3, sections 4.3.7
    (before each entry), 4.3.12 (directory) and 4.3.16 (its end).
    """
    parts, directory, place = list[Buffer](), list[bytes](), 0
    for name, head, body in entries:
        size = len(head) + len(body)
        known = _ENTRY.pack(_VERSION, 0, 0, 0, _EPOCH, crc32(body, crc32(head)), size, size, len(name), 0)
        title = name.encode()
        parts += (b"PK\x03\x04", known, title, head, body)
        directory += (b"PK\x01\x02", _MADE_BY, known, _PLACE.pack(0, 0, 0, 0, place), title)
        place += 4 + len(known) + len(title) + size
    listing = b"".join(directory)
    end = _END.pack(0, 0, len(entries), len(entries), len(listing), place, 0)
    return [*parts, listing, b"PK\x05\x06", end]


def _head(array: NDArray[Any]) -> bytes:
    """Header of an array in NPY format 1.0, padded so that the data begin at a multiple of 64 bytes."""
    text = f"{{'descr': {array.dtype.str!r}, 'fortran_order': False, 'shape': {array.shape}, }}"
    text += " " * (-(len(text) + 11) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text.encode()


def load_chunk(path: Path, layout: Layout, objects: Sequence[int] | None = None, *, scans: bool = True) -> Trace:
    """Read the trace of a piece.

    Args:
        path: The piece.
        layout: Properties of the run.
        objects: Indices of the objects that the trace is to have, in this order, with their scans; default: all.
        scans: Whether to read the scans.

    Raises:
        RunError: The file is not one that :func:`pack_chunk` makes.
    """
    with _as_run_error(path), _opened(path) as archive:
        about = read_json(archive.read(_ABOUT), most_bytes=_MAX_BYTES)
        measured = ["ranges", *(["readings"] if "reading_rows" in about else [])] if scans else []
        names = [*_ARRAYS, *measured, *(["command"] if "commanded" in about else [])]
        arrays = {name: read_array(archive, archive.getinfo(f"{name}.npy"), _KINDS) for name in names}
        for array in arrays.values():
            _check_values(array)
        chosen = range(len(layout.names)) if objects is None else objects
        return _trace(about, arrays, layout, list(chosen))


def load_events(path: Path) -> Any:
    """Read the events of a piece, as :func:`pack_chunk` got them.

    Raises:
        RunError: The file is not one that :func:`pack_chunk` makes.
    """
    with _as_run_error(path), _opened(path) as archive:
        return read_json(archive.read(_ABOUT), most_bytes=_MAX_BYTES)["events"]


@contextmanager
def _as_run_error(path: Path) -> Iterator[None]:
    """Turn any error about the content of a file into a RunError."""
    try:
        yield
    except (
        OSError,
        ValueError,
        KeyError,
        IndexError,
        TypeError,
        AttributeError,
        OverflowError,
        ContentError,
    ) as error:
        raise unreadable(f"'{path.name}' of run {path.parent.name} has been changed: {error}") from None


def _trace(about: dict[str, Any], arrays: dict[str, NDArray[Any]], layout: Layout, chosen: list[int]) -> Trace:
    first, rows = int(about["first"]), int(about["rows"])
    count, beams = len(layout.names), sum(number for _, number in layout.sensors)
    if first < 0 or not 0 < rows * max(1, len(chosen) * 3, beams) <= _MAX_NUMBERS:
        raise ValueError("more rows than irsim writes")
    movers, columns = [int(row) for row in about["movers"]], arrays["control"].shape[-1]
    if movers and not 0 <= min(movers) <= max(movers) < count:
        raise ValueError("movers out of range")
    _expect(arrays["pose_at"], (count, 3))
    _expect(arrays["pose"], (rows, len(movers), 3))
    _expect(arrays["control"], (rows, len(movers), columns))
    place = {row: number for number, row in enumerate(movers)}
    targets = [target for target, row in enumerate(chosen) if row in place]
    sources = [place[chosen[target]] for target in targets]
    pose = np.repeat(arrays["pose_at"][None, chosen], rows, axis=0)
    pose[:, targets] = arrays["pose"][:, sources]
    control = np.zeros((rows, len(chosen), 3))
    control[:, targets, :columns] = arrays["control"][:, sources]
    command = None
    if "command" in arrays:
        commanded = [int(row) for row in about["commanded"]]
        _expect(arrays["command"], (rows, len(commanded), columns))
        command = np.full((rows, count, 3), np.nan)
        command[:, commanded, :columns] = arrays["command"]
        command[:, commanded, columns:] = 0.0
        command = command[:, chosen]
    names = tuple(layout.names[row] for row in chosen)
    flags = _expand(about["flag_rows"], arrays["flags"], rows, (count,), chosen).astype(np.uint8)
    ranges: dict[str, NDArray[np.float32]] = {}
    if layout.sensors and "ranges" in arrays:
        scans = np.zeros((0, beams), dtype=np.float32)
        if about["scan_rows"]:
            scans = _expand(about["scan_rows"], arrays["ranges"], rows, (beams,)).astype(np.float32, copy=False)
        cuts = np.cumsum([number for _, number in layout.sensors])[:-1]
        parts = zip(layout.sensors, np.split(scans, cuts, axis=1), strict=True)
        ranges = {key: part for (key, _), part in parts if key.rpartition("/")[0] in names}
    step = np.arange(first, first + rows, dtype=np.int64)
    readings = (
        _readings(about, arrays.get("readings"), rows, layout, names) if layout.gauges and "ranges" in arrays else {}
    )
    return Trace(
        step=step,
        time=step.astype(np.float64) * layout.step_time,
        pose=pose,
        control=control,
        command=command,
        goal=_expand(about["goal_rows"], arrays["goal"], rows, (count, 3), chosen),
        arrived=(flags & _BITS["arrived"]).astype(bool),
        collided=(flags & _BITS["collided"]).astype(bool),
        stopped=(flags & _BITS["stopped"]).astype(bool),
        ranges=ranges,
        names=names,
        step_time=layout.step_time,
        readings=readings,
    )


def _readings(
    about: dict[str, Any], values: NDArray[Any] | None, rows: int, layout: Layout, names: Sequence[str]
) -> dict[str, NDArray[np.void]]:
    """The numbers of each sensor of the chosen objects, see ``Trace.readings``; without values they have no rows."""
    counts = [count for _, _, count in layout.gauges]
    all_of_them = np.zeros((0, sum(counts)))
    if values is not None:
        all_of_them = _expand(about["reading_rows"], values, rows, (sum(counts),))
    readings = {}
    parts = np.split(all_of_them, np.cumsum(counts)[:-1], axis=1)
    for (key, columns, count), part in zip(layout.gauges, parts, strict=True):
        if key.rpartition("/")[0] not in names:
            continue
        if not columns or count % len(columns) or len(set(columns)) != len(columns):
            raise ValueError(f"'{key}' has no {count} numbers")
        readings[key] = by_name(part, columns)
    return readings


def _expand(
    begins: Sequence[int], values: NDArray[Any], rows: int, shape: tuple[int, ...], chosen: list[int] | None = None
) -> NDArray[Any]:
    """(T, …) array, one row per step, of values that each hold from their row on; only of the chosen objects."""
    _expect(values, (len(begins), *shape))
    if chosen is not None:
        values = values[:, chosen]
    if not values.size:
        return np.zeros((rows, *values.shape[1:]), dtype=values.dtype)
    lengths = np.diff([*begins, rows])
    if begins[0] != 0 or (lengths <= 0).any():
        raise ValueError("rows out of order")
    return np.repeat(values, lengths, axis=0)


def _expect(array: NDArray[Any], shape: tuple[int, ...]) -> None:
    if array.shape != shape:
        raise ValueError(f"an array must have shape {shape}, got {array.shape}")


def _check_values(array: NDArray[Any]) -> None:
    """Refuse numbers with which no world works; positions of absent objects and missing ranges are not finite."""
    if array.dtype.kind == "f" and (np.isfinite(array) & (np.abs(array) > _MAX_LENGTH_M)).any():
        raise ValueError("a number is larger than any that irsim writes")


def _opened(path: Path) -> AbstractContextManager[ZipFile]:
    """The archive of a piece; compressed ones could unpack to any size, and pieces are never compressed."""
    return opened_archive(path, most_bytes=_MAX_BYTES, most_entries=_MAX_ENTRIES, packed=False)


class PieceWriter:
    """Does one piece of work at a time in a thread of its own.

    The core releases the interpreter while it simulates, and the operating system while it copies bytes, so both go on
    side by side. There is no thread until the first piece is submitted, because short runs have only one.
    """

    def __init__(self) -> None:
        self._lock = Lock()
        self._piece: Callable[[], None] | None = None
        self._error: BaseException | None = None

    def submit(self, write: Callable[[], None]) -> None:
        """Begin a piece of work; the one before must be over, see :meth:`wait`."""
        self._piece = write
        Thread(target=self._do, name="irsim-recorder", daemon=True).start()

    def wait(self) -> None:
        """Wait until the last piece is written, and raise the error that this has raised.

        A piece whose thread has not begun, because an interrupt came while it was started, is written here.
        """
        self._do()
        error, self._error = self._error, None
        if error is not None:
            raise error

    def _do(self) -> None:
        with self._lock:
            write, self._piece = self._piece, None
            try:
                if write is not None:
                    write()
            except BaseException as error:
                self._error = error
