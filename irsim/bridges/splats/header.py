"""Headers of PLY files.

The format follows Turk, "The PLY polygon file format" (1994).
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NoReturn

from irsim.bridges.base import BridgeError
from irsim.common.text import clean

__all__ = ["Element", "Header", "Property", "read_header"]

_MAX_HEADER_BYTES = 64 * 1024
_MAX_DIGITS = 15
"""Most digits of a number of elements; more elements do not fit into a file."""
_SIZES = {
    "char": 1, "uchar": 1, "short": 2, "ushort": 2, "int": 4, "uint": 4, "float": 4, "double": 8,
    "int8": 1, "uint8": 1, "int16": 2, "uint16": 2, "int32": 4, "uint32": 4, "float32": 4, "float64": 8,
}  # fmt: skip
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
        code: NumPy's code of the type without byte order; empty for lists.
    """

    name: str
    kind: str
    code: str

    @property
    def size(self) -> int:
        """Number of bytes; 0 for lists."""
        return _SIZES.get(self.kind, 0)


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

    @property
    def row_bytes(self) -> int:
        """Bytes of a row in a binary file."""
        return sum(item.size for item in self.properties)


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


def read_header(path: Path) -> Header:
    """Read the header of a PLY file.

    Raises:
        BridgeError: The file cannot be read or is not a PLY file; the message has the line.
    """
    try:
        with path.open("rb") as file:
            begin = file.read(_MAX_HEADER_BYTES)
    except OSError as error:
        what = f"'{clean(path, 200)}' cannot be read: {error.strerror or error}"
        raise BridgeError("bridge-file", what, "name a .ply file that exists") from None
    end = re.search(rb"(?:^|\n)end_header\r?\n", begin)
    if not re.match(rb"ply\r?\n", begin):
        _refuse(path, 1, "it does not begin with 'ply'")
    if end is None:
        _refuse(path, begin.count(b"\n") + 1, f"its header has no line 'end_header' in the first {len(begin):,} bytes")
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
                    _refuse(path, number, f"it has the element '{clean(name, 40)}' twice")
                elements.append((name, int(count), []))
            case ["property", "list", counts, kind, name] if elements and counts in _SIZES and kind in _SIZES:
                elements[-1][2].append(Property(name, "list", ""))
            case ["property", kind, name] if elements and kind in _SIZES:
                if any(name == other.name for other in elements[-1][2]):
                    _refuse(path, number, f"it has the property '{clean(name, 40)}' twice")
                elements[-1][2].append(Property(name, kind, _CODES[kind]))
            case _:
                _refuse(path, number, f"this line is not one of a PLY header: '{clean(line, 60)}'")
    if encoding is None:
        _refuse(path, 2, "its header has no line 'format'")
    return Header(encoding, tuple(Element(name, count, tuple(items)) for name, count, items in elements), end.end())


def _refuse(path: Path, line: int, what: str) -> NoReturn:
    raise BridgeError(
        "bridge-file", f"'{clean(path, 200)}', line {line}: {what}", "give a .ply file of Gaussian splats"
    )
