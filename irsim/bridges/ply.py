"""The header of PLY files, of meshes and of splats.

Source: Turk, "The PLY polygon file format" (1994).
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NoReturn

from irsim.bridges.base import BridgeError
from irsim.common.text import clean

__all__ = ["Element", "Header", "Property", "read_header"]

_MAX_BYTES = 64 * 1024
_MAX_DIGITS = 15
"""Most digits of a number of elements; more elements do not fit into a file."""
_CODES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4",
    "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4",
    "float32": "f4", "float64": "f8",
}  # fmt: skip
Encoding = Literal["ascii", "binary_little_endian", "binary_big_endian"]


@dataclass(frozen=True)
class Property:
    """A property of an element.

    Attributes:
        name: Its name.
        kind: Type as the file names it; ``list`` for lists.
        code: NumPy's code of the type, or of the elements of a list, without byte order.
        counts: The same of the number before the elements of a list; empty for all others.
    """

    name: str
    kind: str
    code: str
    counts: str = ""

    def size(self, elements: int = 0) -> int:
        """Number of bytes in a binary file; ``elements`` is the length of a list."""
        return int(self.counts[1]) + elements * int(self.code[1]) if self.counts else int(self.code[1])


@dataclass(frozen=True)
class Element:
    """A kind of rows.

    Attributes:
        name: Its name.
        count: Number of rows.
        properties: Its columns.
    """

    name: str
    count: int
    properties: tuple[Property, ...]

    @property
    def has_lists(self) -> bool:
        """Whether its rows differ in size."""
        return any(item.kind == "list" for item in self.properties)

    def row_bytes(self, elements: int = 0) -> int:
        """Bytes of a row in a binary file; ``elements`` is the length of each list."""
        return sum(item.size(elements) for item in self.properties)


@dataclass(frozen=True)
class Header:
    """The beginning of a PLY file.

    Attributes:
        encoding: How numbers are written.
        elements: Kinds of rows, in the order of the file.
        size: Number of bytes of the header, at which the rows begin.
    """

    encoding: Encoding
    elements: tuple[Element, ...]
    size: int

    def element(self, name: str) -> Element | None:
        """The element with a name, if there is one."""
        return next((item for item in self.elements if item.name == name), None)


def read_header(path: Path, fix: str) -> Header:
    """Read the header of a PLY file.

    Args:
        path: The file.
        fix: Advice in messages: the file to give in its place.

    Raises:
        BridgeError: The file cannot be read or is not a PLY file; the message has the line.
    """
    try:
        with path.open("rb") as file:
            begin = file.read(_MAX_BYTES)
    except OSError as error:
        what = f"'{clean(path, 200)}' cannot be read: {error.strerror or error}"
        raise BridgeError("bridge-file", what, "name a .ply file that exists") from None
    end = re.search(rb"(?:^|\n)end_header\r?\n", begin)
    if not re.match(rb"ply\r?\n", begin):
        _refuse_line(path, fix, 1, "it does not begin with 'ply'")
    if end is None:
        _refuse_line(
            path, fix, begin.count(b"\n") + 1, f"its header has no line 'end_header' in the first {len(begin):,} bytes"
        )
    lines = begin[: end.start()].decode("ascii", errors="replace").splitlines()
    encoding: Encoding | None = None
    elements: list[tuple[str, int, list[Property]]] = []
    for number, line in enumerate(lines[1:], start=2):
        words = line.split()
        match words:
            case [] | ["comment" | "obj_info", *_]:
                continue
            case ["format", ("ascii" | "binary_little_endian" | "binary_big_endian") as name, "1.0"]:
                encoding = name
            case ["element", name, count] if count.isdecimal() and len(count) <= _MAX_DIGITS:
                if any(name == other for other, _, _ in elements):
                    _refuse_line(path, fix, number, f"it has the element '{clean(name, 40)}' twice")
                elements.append((name, int(count), []))
            case ["property", "list", counts, kind, name] if elements and counts in _CODES and kind in _CODES:
                elements[-1][2].append(Property(name, "list", _CODES[kind], _CODES[counts]))
            case ["property", kind, name] if elements and kind in _CODES:
                if any(name == other.name for other in elements[-1][2]):
                    _refuse_line(path, fix, number, f"it has the property '{clean(name, 40)}' twice")
                elements[-1][2].append(Property(name, kind, _CODES[kind]))
            case _:
                _refuse_line(path, fix, number, f"this line is not one of a PLY header: '{clean(line, 60)}'")
    if encoding is None:
        _refuse_line(path, fix, 2, "its header has no line 'format'")
    return Header(encoding, tuple(Element(name, count, tuple(items)) for name, count, items in elements), end.end())


def _refuse_line(path: Path, fix: str, line: int, what: str) -> NoReturn:
    what = f"'{clean(path, 200)}', line {line}: {what}"
    raise BridgeError("bridge-file", what, fix)
