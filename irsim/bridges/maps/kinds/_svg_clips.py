"""Clip paths of SVG: each element that has one gets the shapes of the clip path beside or inside it, marked as such.

The library that reads shapes drops clip paths. Shapes that stand in the tree are placed, used again and transformed by
it as all others are, so that the reader only has to intersect areas.
"""

from __future__ import annotations

import copy
import re
import xml.etree.ElementTree as ET
from pathlib import Path

from irsim.bridges.maps.source import unusable
from irsim.common.text import plural

__all__ = ["CLIP", "CLIPPED", "MARKS", "UNREAD", "insert_clips"]

MARKS = "data-irsim-"
"""Beginning of the names of attributes that are added here, and taken away from files that have them."""
CLIP = f"{MARKS}clip"
"""Attribute of the shapes of a clip path: its number."""
CLIPPED = f"{MARKS}clipped-by-"
"""Beginning of the attribute of elements that a clip path cuts off; its number follows."""
UNREAD = f"{MARKS}unread-clip"
"""Attribute of elements with a clip path or a mask that is not read."""
_ADDRESS = re.compile(r"\Aurl\(\s*['\"]?#([^'\")]+)['\"]?\s*\)")
_CONTAINERS = ("svg", "g", "symbol")
_MAX_COPIES = 200_000
"""Number of shapes when each element has a copy of the shapes of its clip path."""


def insert_clips(path: Path, root: ET.Element, clips: dict[str, ET.Element]) -> list[str]:
    """Insert the shapes of clip paths, and mark elements whose clip path or mask is not read.

    Args:
        path: The file, for messages.
        root: The tree, which is changed in place.
        clips: The clip paths by their ids.

    Returns:
        A remark if a style sheet names clip paths, which is not read.

    Raises:
        BridgeError: There are too many shapes in clip paths.
    """
    parents = {child: parent for parent in root.iter() for child in parent}
    elements = [item for item in root.iter() if item.tag != "style"]
    copies = 0
    for number, element in enumerate(elements):
        value = _property(element, "clip-path")
        if _property(element, "mask") not in ("", "none"):
            element.set(UNREAD, "mask")
        if value in ("", "none"):
            continue
        address = _ADDRESS.match(value)
        if address and address[1] not in clips:
            continue  # as in a browser
        clip = clips[address[1]] if address else None
        if clip is None or not _is_readable(clip) or (element not in parents and element.tag not in _CONTAINERS):
            element.set(UNREAD, "clip-path")
            continue
        copies += sum(1 for _ in clip.iter())
        if copies > _MAX_COPIES:
            raise unusable(path, f"its clip paths have more than {_MAX_COPIES:,} shapes", "leave out clip paths")
        _insert(element, parents.get(element), clip, str(number))
    sheets = sum("clip-path" in (item.text or "") for item in root.iter("style"))
    return [f"clip paths that {plural(sheets, 'style sheet')} name are not read"] if sheets else []


def _property(element: ET.Element, name: str) -> str:
    """The value of an attribute, or of the style, which goes before it."""
    pairs = [pair.split(":", 1) for pair in element.get("style", "").split(";") if ":" in pair]
    style = {key.strip(): value.strip() for key, value in pairs}
    return style.get(name, element.get(name, "")).strip()


def _is_readable(clip: ET.Element) -> bool:
    """Whether a clip path consists of shapes in the units of what it cuts off."""
    inside = [clip, *clip.iter()]
    bound = clip.get("clipPathUnits", "userSpaceOnUse") != "userSpaceOnUse"
    return not bound and not any(_property(item, "clip-path") not in ("", "none") for item in inside)


def _insert(element: ET.Element, parent: ET.Element | None, clip: ET.Element, number: str) -> None:
    """Put the shapes of a clip path before what they cut off."""
    shapes = ET.Element("g", {CLIP: number})
    if clip.get("transform"):
        shapes.set("transform", clip.get("transform", ""))
    for child in clip:
        shapes.append(copy.deepcopy(child))
    for item in shapes.iter():
        item.attrib.pop("id", None)
    if element.tag in _CONTAINERS:
        element.set(CLIPPED + number, "yes")
        element.insert(0, shapes)
        return
    assert parent is not None
    group = ET.Element("g", {CLIPPED + number: "yes"})
    name = element.attrib.pop("id", None)
    if name is not None:
        group.set("id", name)
        element.set("label", element.get("label", name))
    places = [element.get("transform", "")]
    if element.tag == "use":
        places.append(f"translate({element.get('x', '0')}, {element.get('y', '0')})")
    outer = ET.Element("g", {"transform": " ".join(filter(None, places))})
    outer.append(shapes)
    parent[list(parent).index(element)] = group
    group.extend([outer, element])
