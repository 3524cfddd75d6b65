"""Data sets of pedestrians: rows of frame, person and place, read line by line and within limits, and their tracks."""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.base import BridgeError
from irsim.common.arrays import Floats
from irsim.common.text import clean

__all__ = [
    "FORMATS",
    "PERIOD",
    "VSP_RATE",
    "FormatName",
    "Recording",
    "Track",
    "Window",
    "frame_rate",
    "make_tracks",
    "pixels_to_metres",
    "read_homography",
    "read_recording",
]

FormatName: TypeAlias = Literal["obsmat", "vsp", "trajnet"]
Numbers: TypeAlias = "array[float]"
"""Rows of frame, person, x, y, one after the other."""
FORMATS: tuple[FormatName, ...] = ("obsmat", "vsp", "trajnet")
"""ETH's ``obsmat.txt``, UCY's ``.vsp``, and lines ``frame id x y`` as in TrajNet."""

_MAX_BYTES = 128 * 1024 * 1024
_MAX_LINES = 4_000_000
_MAX_LINE = 4096
"""Longest line [characters]."""
_MAX_ROWS = 1_000_000
_MAX_WHOLE = 2.0**53
"""Numbers of frames and persons beyond this are not exact."""
_MAX_PLACE = 1e6
"""Largest coordinate: of metres, and of pixels."""
_COLUMNS: dict[int, FormatName] = {8: "obsmat", 4: "trajnet"}
_PLACES: dict[FormatName, tuple[int, int]] = {"obsmat": (2, 4), "trajnet": (2, 3)}
"""Columns of x and y: ETH writes x, z, y."""
_EXPECTED: dict[FormatName, str] = {
    "obsmat": "8 numbers: frame, id, x, z, y, vx, vz, vy",
    "trajnet": "4 numbers: frame, id, x, y",
    "vsp": "4 numbers: x, y, frame, gaze",
}


@dataclass(frozen=True)
class Recording:
    """Rows of a file, in its order.

    Attributes:
        format: Its format.
        frame: (N,) number of the picture.
        person: (N,) id of the person; of splines, their number in the file.
        place: (N, 2) x, y: [m], or pixels from the middle of the picture for ``vsp``.
        unknown: Number of rows with ``?``, as test files of TrajNet have them, which are left out.
    """

    format: FormatName
    frame: Floats
    person: Floats
    place: Floats
    unknown: int = 0


def read_recording(path: Path, form: FormatName | None = None) -> Recording:
    """Read a file.

    Args:
        path: The file.
        form: Its format; default: as suffix and number of columns say.

    Raises:
        BridgeError: The file is none of that format, truncated, or too large.
    """
    lines = _lines(path)
    if form is None and path.suffix.lower() == ".vsp":
        form = "vsp"
    rows, unknown = (_read_splines(path, lines) if form == "vsp" else None), 0
    if rows is None:
        form, rows, unknown = _read_table(path, lines, form)
    assert form is not None
    table = np.frombuffer(rows, dtype=np.float64).reshape(-1, 4)
    return Recording(form, table[:, 0], table[:, 1], table[:, 2:], unknown)


def read_homography(path: Path) -> Floats:
    """(3, 3) matrix that maps pixels to metres, from a file with nine numbers.

    Raises:
        BridgeError: The file does not hold such a matrix.
    """
    result: list[float] = []
    for number, text in _lines(path):
        result += _numbers(path, number, text, "3 numbers", None)
        if len(result) > 9:
            break
    matrix = np.array(result)
    if matrix.size != 9 or abs(np.linalg.det(matrix.reshape(3, 3))) < 1e-30:
        what = f"{_name(path)} is not a homography, which are 9 numbers that make an invertible matrix"
        raise BridgeError("bridge-file", what, "give a file with three lines of three numbers")
    return matrix.reshape(3, 3)


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the numbers and texts of lines that are neither empty nor comments."""
    try:
        size = path.stat().st_size
        if not path.is_file():
            raise BridgeError("bridge-file", f"{_name(path)} is not a file", "name a file of recorded pedestrians")
        if size > _MAX_BYTES:
            what = f"{_name(path)} has {size / 1e6:.0f} MB, more than {_MAX_BYTES / 1e6:.0f} MB"
            raise BridgeError("bridge-file", what, "cut a part out of it, such as its first lines")
        with open(path, encoding="utf-8-sig", errors="replace") as file:
            number = 0
            while line := file.readline(_MAX_LINE + 1):
                number += 1
                if number > _MAX_LINES:
                    raise _bad(path, number, f"is one of more than {_MAX_LINES}", "cut a part out of the file")
                if len(line) > _MAX_LINE:
                    raise _bad(path, number, f"is longer than {_MAX_LINE} characters", "give a text file")
                text = line.strip()
                if text and not text.startswith("#"):
                    yield number, text
    except OSError as error:
        what = f"{_name(path)} cannot be read: {error.strerror or error}"
        raise BridgeError("bridge-file", what, "name a file of recorded pedestrians") from None


def _read_table(
    path: Path, lines: Iterator[tuple[int, str]], form: FormatName | None
) -> tuple[FormatName, Numbers, int]:
    """Format and rows of a table, and how many rows say nothing of a place."""
    rows: Numbers = array("d")
    first, unknown = True, 0
    for number, text in lines:
        header, first = first and _is_header(_fields(text.lower())), False
        if header:
            continue
        if form is None:
            count = len(_fields(text))
            if count not in _COLUMNS:
                what = f"has {count} columns, and files of pedestrians have 4 or 8"
                raise _bad(path, number, what, "write 'frame id x y' or 'frame id x z y vx vz vy'")
            form = _COLUMNS[count]
        if "?" in _fields(text):
            unknown += 1
            continue
        values = _numbers(path, number, text, _EXPECTED[form], 4 if form == "trajnet" else 8)
        x, y = (values[column] for column in _PLACES[form])
        rows.extend(_row(path, number, values[0], values[1], x, y))
        _check_count(path, number, rows)
    if form is None:
        raise BridgeError("bridge-file", f"{_name(path)} is empty", "name a file of recorded pedestrians")
    return form, rows, unknown


def _read_splines(path: Path, lines: Iterator[tuple[int, str]]) -> Numbers:
    """Read control points of splines: a count, then for each spline its count and its points x, y, frame, gaze."""
    rows: Numbers = array("d")
    splines = _count(path, *_next(path, lines, "the number of splines"))
    for spline in range(splines):
        points = _count(path, *_next(path, lines, f"spline {spline + 1} of {splines}"))
        for point in range(points):
            number, text = _next(path, lines, f"point {point + 1} of {points} of spline {spline + 1}")
            x, y, frame, _ = _numbers(path, number, text.split(" - ")[0], _EXPECTED["vsp"], 4)
            rows.extend(_row(path, number, frame, float(spline), x, y))
            _check_count(path, number, rows)
    return rows


def _next(path: Path, lines: Iterator[tuple[int, str]], what: str) -> tuple[int, str]:
    result = next(lines, None)
    if result is None:
        raise BridgeError("bridge-file", f"{_name(path)} ends before {what}", "give the whole file: it is truncated")
    return result


def _count(path: Path, number: int, text: str) -> int:
    word = text.split()[0]
    if not word.isascii() or not word.isdigit() or len(word) > 9:
        raise _bad(path, number, f"must begin with a count, got {clean(word, 40)!r}", "give the whole file")
    return int(word)


def _is_header(names: list[str]) -> bool:
    """Whether a line names the columns of a table of frame, person, x and y."""
    if len(names) != 4 or names[2:] != ["x", "y"] or "frame" not in names[0]:
        return False
    return any(word in names[1] for word in ("id", "ped", "agent", "track"))


def _fields(text: str) -> list[str]:
    return text.replace(",", " ").split()


def _numbers(path: Path, number: int, text: str, expected: str, count: int | None) -> list[float]:
    """The numbers of a line, as many as expected and all finite."""
    fields = _fields(text)
    if count is not None and len(fields) != count:
        raise _bad(path, number, f"has {len(fields)} columns instead of {expected}", "repair or remove the line")
    values = []
    for field in fields:
        try:
            value = float(field)
        except ValueError:
            raise _bad(path, number, f"has {clean(field, 40)!r} instead of a number", "repair the line") from None
        if not math.isfinite(value):
            raise _bad(path, number, f"has {clean(field, 40)!r}, which is not finite", "repair or remove the line")
        values.append(value)
    return values


def _row(path: Path, number: int, frame: float, person: float, x: float, y: float) -> list[float]:
    for name, value in (("frame", frame), ("id", person)):
        if abs(value) > _MAX_WHOLE:
            raise _bad(path, number, f"has the {name} {value:g}, which is too large", "repair or remove the line")
    if person != math.floor(person):
        raise _bad(path, number, f"has the id {person:g}, which is not whole", "are the columns in another order?")
    if max(abs(x), abs(y)) > _MAX_PLACE:
        raise _bad(path, number, f"has the place ({x:g}, {y:g}), which is too far away", "repair or remove the line")
    return [frame, person, x, y]


def _check_count(path: Path, number: int, rows: Numbers) -> None:
    if len(rows) > 4 * _MAX_ROWS:
        what = f"is row {len(rows) // 4}, and at most {_MAX_ROWS} are read"
        raise _bad(path, number, what, "cut a part out of the file")


def _bad(path: Path, number: int, what: str, fix: str) -> BridgeError:
    return BridgeError("bridge-file", f"line {number} of {_name(path)} {what}", fix)


def _name(path: Path) -> str:
    return f"'{clean(path.name, 100)}'"


PERIOD = 0.4
"""Time between two annotated pictures of ETH and TrajNet, if no frame rate is given [s]."""
VSP_RATE = 25.0
"""Frames per second of UCY's videos."""
_MAX_DURATION = 1e6
"""Longest recording [s]."""


@dataclass(frozen=True)
class Window:
    """The part of a recording that is kept.

    Attributes:
        start: Time from which on, since its first frame [s].
        end: Time until which, since its first frame [s].
        box: x0, y0, x1, y1 of the area [m]; None keeps all.
    """

    start: float = 0.0
    end: float = float("inf")
    box: tuple[float, float, float, float] | None = None


@dataclass(frozen=True)
class Track:
    """A part of a person's recording without interruption.

    Attributes:
        name: ``ped_<id>``; another track of the same person has ``_2``, ``_3``, ... behind it.
        times: (K,) increasing, from the start of the window [s]; K >= 2.
        places: (K, 2) x, y [m].
    """

    name: str
    times: Floats
    places: Floats


def frame_rate(recording: Recording) -> float:
    """Frames per second, from what data sets agree on: see :data:`PERIOD` and :data:`VSP_RATE`."""
    if recording.format == "vsp":
        return VSP_RATE
    frames = np.unique(recording.frame)
    if len(frames) < 2:
        return 1.0 / PERIOD
    steps, counts = np.unique(np.diff(frames), return_counts=True)
    return float(steps[counts.argmax()]) / PERIOD


def pixels_to_metres(
    places: Floats, homography: Floats | None, scale: float | None, size: tuple[float, float] | None
) -> Floats:
    """Places on the ground of places in a picture.

    Args:
        places: (N, 2) pixels from the middle of the picture, y upwards.
        homography: (3, 3) from pixels to metres; None to scale.
        scale: Metres of a pixel; None with a homography.
        size: Width and height of the picture [pixels], if the homography counts pixels from its upper left corner, y
            downwards.

    Raises:
        BridgeError: A place has no image on the ground.
    """
    if homography is None:
        assert scale is not None
        return places * scale
    if size is not None:
        places = np.stack([places[:, 0] + size[0] / 2, size[1] / 2 - places[:, 1]], axis=1)
    result = np.concatenate([places, np.ones((len(places), 1))], axis=1) @ homography.T
    with np.errstate(divide="ignore", invalid="ignore"):
        ground: Floats = result[:, :2] / result[:, 2:]
    if not np.isfinite(ground).all() or np.abs(ground).max(initial=0.0) > 1e6:
        what = "the homography maps a place to infinity"
        raise BridgeError("bridge-file", what, "is it one of this video, or its inverse?")
    return ground


def make_tracks(recording: Recording, places: Floats, rate: float, window: Window) -> tuple[list[Track], int]:
    """The tracks of a recording, in the order of the ids.

    Args:
        recording: The rows.
        places: (N, 2) x, y [m] of the rows.
        rate: Frames per second.
        window: Part of the recording that is kept.

    Returns:
        The tracks, and how many persons were left out because a single row of them is in the window.

    Raises:
        BridgeError: A pedestrian is at two places in one frame, or the recording is longer than 11 days.
    """
    if not len(recording.frame):
        return [], 0
    times = (recording.frame - recording.frame.min()) / rate
    if times.max() > _MAX_DURATION:
        what = f"the recording lasts {times.max():g} s"
        raise BridgeError("bridge-file", what, "a number of a frame is wrong, or the frame rate is")
    order = np.lexsort((times, recording.person))
    times, person, places = times[order], recording.person[order], places[order]
    same = (np.diff(person) == 0) & (np.diff(times) == 0)
    if same.any():
        at = int(np.flatnonzero(same)[0])
        if not np.array_equal(places[:-1][same], places[1:][same]):
            what = f"person {person[at]:.0f} is at two places in frame {recording.frame[order][at]:g}"
            raise BridgeError("bridge-file", what, "remove one of the two lines")
        kept = np.concatenate([[True], ~same])
        times, person, places = times[kept], person[kept], places[kept]
    inside = (times >= window.start - 1e-9) & (times <= window.end + 1e-9)
    if window.box is not None:
        x0, y0, x1, y1 = window.box
        inside &= (places[:, 0] >= x0) & (places[:, 0] <= x1) & (places[:, 1] >= y0) & (places[:, 1] <= y1)
    tracks: list[Track] = []
    left_out = 0
    for who in np.unique(person).tolist():
        rows = np.flatnonzero(person == who) if len(person) < 2 else _range(person, who)
        number = 0
        for run in _runs(inside[rows]):
            part = rows[run]
            if len(part) < 2:
                left_out += 1
                continue
            number += 1
            name = f"ped_{who:.0f}" if number == 1 else f"ped_{who:.0f}_{number}"
            tracks.append(Track(name.replace("-", "m"), times[part] - window.start, places[part]))
    return tracks, left_out


def _range(person: Floats, who: float) -> NDArray[np.int64]:
    return np.arange(np.searchsorted(person, who), np.searchsorted(person, who, side="right"))


def _runs(inside: NDArray[np.bool_]) -> Iterator[slice]:
    """Slices of consecutive rows that are inside."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]).astype(np.int8)))
    for begin, end in edges.reshape(-1, 2).tolist():
        yield slice(begin, end)
