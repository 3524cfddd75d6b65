"""Read Gaussian splats from PLY files in the layout in which the first program for them wrote them.

Each row has the center ``x y z``, the color ``f_dc_0..2``, coefficients of harmonics ``f_rest_*`` (all red ones, all
green ones, all blue ones; they may be absent), the logit of the opacity, the logarithms of the standard deviations
``scale_0..2`` and the quaternion ``rot_0..3`` with w first. Other columns are skipped. Sources: Turk, "The PLY polygon
file format" (1994); Kerbl, Kopanas, Leimkühler, Drettakis: 3D Gaussian Splatting for Real-Time Radiance Field Rendering
(2023).
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, NoReturn

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.base import BridgeError
from irsim.bridges.ply import Element, Header, read_header
from irsim.bridges.splats.splats import Singles, Splats
from irsim.common.text import clean

__all__ = ["MAX_SPLATS", "SPLATS_FIX", "read_splats"]

MAX_SPLATS = 20_000_000
"""Most splats of a file; their arrays take 56 bytes each, and 180 more with harmonics of degree 3."""
_FIELDS = (
    "x", "y", "z", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3", "opacity",
    "f_dc_0", "f_dc_1", "f_dc_2",
)  # fmt: skip
_TERMS = (3, 8, 15)
"""Coefficients of the harmonics of the degrees 1, 1 to 2 and 1 to 3, for each color."""
_CHUNK_BYTES = 1 << 24
_MAX_WORD = 64
"""Length of a number in a text file."""
_MAX_LOG_SCALE = 25.0
"""Logarithm of a standard deviation that no scene has, whose square still is a number in single precision."""
_MAX_LOGIT = 80.0
"""Logit of an opacity that is 1 in single precision; some programs write infinity."""
_MAX_PLACE = 1e9
"""Coordinate that no scene has."""
SH_0 = 0.28209479177387814
"""Value of the spherical harmonic of degree 0."""
SPLATS_FIX = "give a .ply file of Gaussian splats"
_FIX = "export the scene as a .ply file of Gaussian splats without compression, and give the whole file"


def read_splats(path: str | Path, *, harmonics: bool = False) -> Splats:
    """Read splats.

    Args:
        path: File in the format PLY: binary with either byte order, or text.
        harmonics: Whether to read the colors that change with the view direction, too.

    Raises:
        BridgeError: The file cannot be read, is truncated, lacks a column, or has a value that is not a number.
    """
    source = Path(path)
    header = read_header(source, SPLATS_FIX)
    vertex = _checked(source, header, os.path.getsize(source))
    terms = _terms(source, vertex) if harmonics else 0
    fields = [*_FIELDS, *(f"f_rest_{number}" for number in range(3 * terms))]
    table = np.empty((vertex.count, len(fields)), dtype=np.float32)
    at = 0
    try:
        with source.open("rb") as file:
            file.seek(header.size)
            parts = _text_rows if header.encoding == "ascii" else _binary_rows
            for rows in parts(source, file, header, vertex, fields):
                _check_values(source, rows, fields, at)
                rows[:, 3:6] = np.maximum(rows[:, 3:6], -_MAX_LOG_SCALE)
                rows[:, 10] = np.clip(rows[:, 10], -_MAX_LOGIT, _MAX_LOGIT)
                table[at : at + len(rows)] = rows
                at += len(rows)
    except OSError as error:
        raise _error(source, f"it cannot be read: {error.strerror or error}") from None
    if at < vertex.count:
        _refuse(source, f"it ends after {at:,} of {vertex.count:,} splats")
    return _from_table(table, terms)


def _checked(path: Path, header: Header, size: int) -> Element:
    """The element with the splats, if it can be what it says to be."""
    vertex = header.element("vertex")
    if vertex is None:
        _refuse(path, "it has no element 'vertex'")
    names = {item.name: item for item in vertex.properties}
    if "packed_position" in names:
        _refuse(path, "its splats are compressed ('packed_position')")
    missing = [name for name in _FIELDS if name not in names]
    if missing:
        _refuse(path, f"its vertices have no {', '.join(missing)}, so they are not splats")
    for name in _FIELDS:
        if names[name].code not in ("f4", "f8"):
            _refuse(path, f"the property '{name}' is of the type {names[name].kind}; it has to be float or double")
    before = header.elements[: header.elements.index(vertex)]
    if any(item.count for item in before):
        _refuse(path, f"the element '{clean(before[0].name, 40)}' stands before the vertices")
    if vertex.has_lists:
        _refuse(path, "its vertices have lists")
    if vertex.count == 0:
        _refuse(path, "it has no splats")
    if vertex.count > MAX_SPLATS:
        _refuse(path, f"its header tells of {vertex.count:,} splats; at most {MAX_SPLATS:,} are read")
    least = 2 * len(vertex.properties) if header.encoding == "ascii" else vertex.row_bytes()
    wanted = header.size + vertex.count * least - (header.encoding == "ascii")
    if size < wanted:
        _refuse(path, f"it has {size:,} bytes, but {vertex.count:,} splats as in its header take {wanted:,}")
    return vertex


def _terms(path: Path, vertex: Element) -> int:
    """Number of coefficients for each color in the columns ``f_rest_*``."""
    names = {item.name: item for item in vertex.properties}
    count = 0
    while f"f_rest_{count}" in names:
        if names[f"f_rest_{count}"].code not in ("f4", "f8"):
            kind = names[f"f_rest_{count}"].kind
            _refuse(path, f"the property 'f_rest_{count}' is of the type {kind}; it has to be float or double")
        count += 1
    if (count and count // 3 not in _TERMS) or count % 3:
        _refuse(path, f"it has {count} properties f_rest_*; there are 9, 24 or 45 in a file of splats")
    return count // 3


def _binary_rows(
    path: Path, file: BinaryIO, header: Header, vertex: Element, fields: list[str]
) -> Iterator[NDArray[np.float64]]:
    """Yield the wanted columns, a chunk of rows at a time."""
    order = "<" if header.encoding == "binary_little_endian" else ">"
    kind = np.dtype([(item.name, order + item.code) for item in vertex.properties])
    rows = max(1, _CHUNK_BYTES // kind.itemsize)
    for begin in range(0, vertex.count, rows):
        count = min(rows, vertex.count - begin)
        chunk = np.frombuffer(file.read(count * kind.itemsize), dtype=np.uint8)
        if len(chunk) < count * kind.itemsize:
            _refuse(path, f"it ends after {begin + len(chunk) // kind.itemsize:,} of {vertex.count:,} splats")
        read = chunk.view(kind)
        with np.errstate(invalid="ignore"):  # what is not a number is found later
            table = np.stack([read[name].astype(np.float64) for name in fields], axis=1)
        yield table


def _text_rows(
    path: Path, file: BinaryIO, header: Header, vertex: Element, fields: list[str]
) -> Iterator[NDArray[np.float64]]:
    """Yield the wanted columns of a text file, in which rows are words one after the other."""
    width = len(vertex.properties)
    columns = [[item.name for item in vertex.properties].index(name) for name in fields]
    words: list[bytes] = []
    rest, done = b"", 0
    while done < vertex.count:
        chunk = file.read(_CHUNK_BYTES // 16)
        text = rest + chunk
        result = text.split()
        rest = result.pop() if result and chunk and not text[-1:].isspace() else b""
        if len(rest) > _MAX_WORD:
            _refuse(path, f"splat {done:,}: there is a word of more than {_MAX_WORD} characters")
        words += result
        count = min(len(words) // width, vertex.count - done)
        if count:
            try:
                numbers = np.array([float(word) for word in words[: count * width]]).reshape(count, width)
            except ValueError as error:
                _refuse(path, f"splats {done:,} to {done + count - 1:,}: {clean(error, 80)}")
            yield numbers[:, columns]
            words = words[count * width :]
            done += count
        if not chunk:
            return


def _check_values(path: Path, rows: NDArray[np.float64], fields: list[str], first: int) -> None:
    """Refuse values that are not numbers; an infinite logit is an opacity of 0 or 1."""
    bad = ~np.isfinite(rows)
    opacity = fields.index("opacity")
    bad[:, opacity] = np.isnan(rows[:, opacity])
    if bad.any():
        row, column = (int(value) for value in np.argwhere(bad)[0])
        _refuse(path, f"splat {first + row:,}: '{fields[column]}' is {rows[row, column]}")
    for (begin, end), limit in (((0, 3), _MAX_PLACE), ((3, 6), _MAX_LOG_SCALE), ((11, len(fields)), _MAX_PLACE)):
        far = rows[:, begin:end] > limit
        far |= (rows[:, begin:end] < -limit) & (begin != 3)
        if far.any():
            row, column = (int(value) for value in np.argwhere(far)[0])
            _refuse(path, f"splat {first + row:,}: '{fields[begin + column]}' is {rows[row, begin + column]:g}")
    with np.errstate(over="ignore"):
        length = np.linalg.norm(rows[:, 6:10], axis=1)
    flat = ~((length > 1e-12) & (length < 1e12))
    if flat.any():
        _refuse(path, f"splat {first + int(flat.argmax()):,}: its quaternion has no direction")


def _from_table(table: Singles, terms: int) -> Splats:
    """Splats from the columns of the file."""
    rotation = table[:, 6:10] / np.linalg.norm(table[:, 6:10].astype(np.float64), axis=1, keepdims=True)
    with np.errstate(over="ignore"):  # infinity is an opacity of 0
        opacity = 1 / (1 + np.exp(-table[:, 10]))
    harmonics = None
    if terms:
        harmonics = np.ascontiguousarray(table[:, 14:].reshape(len(table), 3, terms).transpose(0, 2, 1))
    return Splats(
        np.ascontiguousarray(table[:, :3]),
        np.exp(table[:, 3:6]),
        rotation.astype(np.float32),
        opacity.astype(np.float32),
        0.5 + np.float32(SH_0) * table[:, 11:14],
        harmonics,
    )


def _error(path: Path, what: str) -> BridgeError:
    return BridgeError("bridge-file", f"'{clean(path, 200)}': {what}", _FIX)


def _refuse(path: Path, what: str) -> NoReturn:
    raise _error(path, what)
