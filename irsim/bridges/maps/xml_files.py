"""Elements of XML files that other people made, without entities, addresses and endless depth."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from pathlib import Path
from xml.parsers import expat

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.source import ImportLimits, unusable

__all__ = ["find_number", "find_numbers", "read_xml"]

_MAX_DEPTH = 256
"""Elements inside each other."""
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
        what = f"{name} is '{text[:60]}', and must be {count or 'some'} number{'s' if count != 1 else ''}"
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
