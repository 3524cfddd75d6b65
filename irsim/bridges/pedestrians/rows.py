"""Rows of frame, person and place from data sets of pedestrians, read line by line and within limits."""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeAlias

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.common.arrays import Floats
from irsim.common.text import clean

__all__ = ["FORMATS", "FormatName", "Recording", "read_homography", "read_recording"]

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
    """

    format: FormatName
    frame: Floats
    person: Floats
    place: Floats


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
    rows = _read_splines(path, lines) if form == "vsp" else None
    if rows is None:
        form, rows = _read_table(path, lines, form)
    assert form is not None
    table = np.frombuffer(rows, dtype=np.float64).reshape(-1, 4)
    return Recording(form, table[:, 0], table[:, 1], table[:, 2:])


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


def _read_table(path: Path, lines: Iterator[tuple[int, str]], form: FormatName | None) -> tuple[FormatName, Numbers]:
    rows: Numbers = array("d")
    first = True
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
        values = _numbers(path, number, text, _EXPECTED[form], 4 if form == "trajnet" else 8)
        x, y = (values[column] for column in _PLACES[form])
        rows.extend(_row(path, number, values[0], values[1], x, y))
        _check_count(path, number, rows)
    if form is None:
        raise BridgeError("bridge-file", f"{_name(path)} is empty", "name a file of recorded pedestrians")
    return form, rows


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
        raise _bad(
            path, number, f"is row {len(rows) // 4}, and at most {_MAX_ROWS} are read", "cut a part out of the file"
        )


def _bad(path: Path, number: int, what: str, fix: str) -> BridgeError:
    return BridgeError("bridge-file", f"line {number} of {_name(path)} {what}", fix)


def _name(path: Path) -> str:
    return f"'{clean(path.name, 100)}'"
