"""Elements of XML files that other people made, without entities, addresses and endless depth.

:class:`Collection` is what importers of simulators' worlds collect of them.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.parsers import expat

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Outlined, Outlines, unusable
from irsim.common.arrays import Floats
from irsim.common.text import clean, plural

__all__ = ["UPRIGHT", "Collection", "find_number", "find_numbers", "read_xml"]

_MAX_DEPTH = 256
"""Elements inside each other."""
_MAX_NAMES = 5
"""Names of elements that a note about what was left out lists."""
UPRIGHT = 1e-6
"""Difference of the cosine of a tilt from 1, below which a thing is upright."""
_LEADING = re.compile(rb"\A(?:\xef\xbb\xbf)?(?:\s|<!--(?:(?!-->).)*-->)*(?=<\?xml)", re.DOTALL)


def read_xml(path: Path, limits: ImportLimits, *, doctypes: bool = False) -> ET.Element:
    """Root of the elements of a file, with names without namespaces.

    What stands before ``<?xml``, such as the comment of a licence, is skipped.

    Args:
        path: The file.
        limits: How large it may be.
        doctypes: Whether it may name a document type, which is not read.

    Raises:
        BridgeError: The file is damaged, too large, declares entities, or is nested too deep.
    """
    size = path.stat().st_size
    if size > limits.bytes:
        raise unusable(path, f"it has {size:,} bytes, and at most {limits.bytes:,} are read", "give a smaller file")
    content = path.read_bytes()
    content = _LEADING.sub(b"", content)
    builder, depth = ET.TreeBuilder(), 0
    parser = expat.ParserCreate(namespace_separator="}")
    parser.buffer_text = True

    def doctype(name: str, system: str | None, public: str | None, inside: bool) -> None:
        if inside or not doctypes:
            raise unusable(path, "it declares a document type, and with it entities, which are not read")

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > _MAX_DEPTH:
            raise unusable(path, f"its elements are nested deeper than {_MAX_DEPTH}")
        builder.start(tag.rpartition("}")[2], {key.rpartition("}")[2]: value for key, value in attributes.items()})

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(tag.rpartition("}")[2])

    parser.StartDoctypeDeclHandler, parser.CharacterDataHandler = doctype, builder.data
    parser.StartElementHandler, parser.EndElementHandler = start, end
    try:
        parser.Parse(content, True)
        return builder.close()
    except BridgeError:
        raise
    except expat.ExpatError as error:
        raise unusable(path, f"it is damaged ({error})") from None
    except (LookupError, ValueError) as error:
        raise unusable(path, f"its text cannot be decoded ({error})") from None


def find_numbers(path: Path, element: ET.Element | None, count: int, default: tuple[float, ...] = ()) -> list[float]:
    """The numbers of an element's text.

    Args:
        path: The file, for messages.
        element: The element; None for the default.
        count: How many there must be; 0 for any number.
        default: The numbers for an element without text, or for no element.

    Raises:
        BridgeError: There are others, or they are not finite numbers.
    """
    text = "" if element is None else (element.text or "").strip()
    if not text and default:
        return list(default)
    try:
        values = [float(word) for word in text.replace(",", " ").split()]
    except ValueError:
        values = [float("nan")]
    if (count and len(values) != count) or any(not abs(value) <= 1e9 for value in values):
        name = "an element" if element is None else f"<{element.tag}>"
        what = f"{name} is '{text[:60]}', and must be {count or 'some'} number{'s' if count != 1 else ''} up to 1e9"
        raise unusable(path, what)
    return values


def find_number(path: Path, parent: ET.Element, name: str, default: float | None = None) -> float:
    """The number that a child element has.

    Raises:
        BridgeError: It is not there, or is not a finite number.
    """
    child = parent.find(name)
    if child is None and default is None:
        raise unusable(path, f"<{parent.tag}> has no <{name}>")
    return find_numbers(path, child, 1, () if default is None else (default,))[0]


@dataclass(kw_only=True)
class Collection:
    """The things that an import collects of the world of another simulator.

    Attributes:
        path: The file.
        options, limits: Options and limits of the import.
        things: Outlines of the obstacles.
        parts: Files that were read.
        left: Reason -> names of what was left out for it.
    """

    path: Path
    options: ImportOptions
    limits: ImportLimits
    things: list[Outlined] = field(default_factory=list)
    parts: list[Path] = field(default_factory=list)
    left: dict[str, list[str]] = field(default_factory=dict)

    @property
    def band(self) -> tuple[float, float]:
        """Heights between which a robot meets what stands there [m]."""
        floor = self.options.height or 0.0
        return floor + self.options.climb, floor + self.options.headroom

    def leave(self, why: str, name: str) -> None:
        """Note that something is left out."""
        self.left.setdefault(why, []).append(clean(name, 80) or "without a name")

    def add(self, name: str, region: Any, place: Floats, radius: float | None) -> None:
        """Collect an outline.

        Args:
            name: Name of the thing.
            region: Its area [m]; None if nothing of it is in the way.
            place: (4, 4) its pose in the world.
            radius: Radius of a cylinder [m], which is a disk if it is upright; None for other shapes.
        """
        if region is not None:
            upright = radius is not None and abs(place[2, 2]) > 1 - UPRIGHT
            disk = (float(place[0, 3]), float(place[1, 3]), radius) if upright and radius is not None else None
            self.things.append(Outlined(name, region, disk))

    def outlines(self) -> Outlines:
        """The result, with a note on each reason why something was left out."""
        notes = []
        for why, names in self.left.items():
            each = sorted(set(names))
            shown = ", ".join(each[:_MAX_NAMES]) + (", …" if len(each) > _MAX_NAMES else "")
            notes.append(f"left out: {plural(len(names), 'element')} ({shown}): {why}")
        return Outlines(self.things, height=self.options.height or 0.0, notes=notes, parts=self.parts)
