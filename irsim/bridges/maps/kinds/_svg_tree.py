"""The tree of an SVG file before a library sees it: only what draws, without references to other files."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from irsim.bridges.maps.kinds._svg_clips import MARKS, insert_clips
from irsim.bridges.maps.source import unusable
from irsim.common.text import clean

__all__ = ["Cleaned", "cleaned"]

_SHAPES = ("path", "rect", "circle", "ellipse", "line", "polyline", "polygon")
_GROUPS = ("svg", "g", "a", "switch", "defs", "symbol", "use")
_SILENT = ("style", "title", "desc", "metadata", "script", "namedview", "view")
_UNDRAWN = ("clipPath", "mask", "pattern", "marker", "filter", "linearGradient", "radialGradient", "font", "cursor")
_NAMES = {"text": "text", "flowRoot": "text", "image": "picture", "foreignObject": "web page"}
_MAX_ELEMENTS = 200_000
"""Shapes after all that is used several times is repeated."""


@dataclass
class Cleaned:
    """A tree that only draws.

    Attributes:
        root: Its root.
        notes: Remarks on what was left out.
    """

    root: ET.Element
    notes: list[str]


def cleaned(path: Path, root: ET.Element, layers: list[str] | None) -> Cleaned:
    """The tree of a file with shapes, groups and styles only, and of those the ones in some layers.

    Args:
        path: The file, for messages.
        root: Its root, with names without namespaces.
        layers: Names of layers or groups that count; None for all.

    Raises:
        BridgeError: It refers to another file or to itself, has no such layer, or draws too many shapes.
    """
    left: Counter[str] = Counter()
    if layers is not None:
        _check_layers(path, root, layers)
    for item in root.iter():
        for key in [key for key in item.attrib if key.startswith(MARKS)]:
            del item.attrib[key]
    clips = {item.get("id", ""): item for item in root.iter("clipPath")}
    for clip in clips.values():
        _prune(path, clip, Counter(), None, chosen=True)
    _prune(path, root, left, None if layers is None else set(layers), chosen=layers is None)
    _check_uses(path, root)
    listed = ", ".join(f"{count} {what}" for what, count in left.most_common(6))
    notes = [f"left out: {listed}"] if left else []
    notes += insert_clips(path, root, clips)
    _check_uses(path, root)
    return Cleaned(root, notes)


def _prune(path: Path, element: ET.Element, left: Counter[str], layers: set[str] | None, *, chosen: bool) -> None:
    """Take away what does not draw.

    Args:
        path: The file, for messages.
        element: Its children are looked at.
        left: Counts of what is left out.
        layers: Names of the layers that count; None for all.
        chosen: Whether the element is in such a layer.
    """
    for child in list(element):
        tag = child.tag
        if tag == "style":
            continue
        inside = chosen or layers is None or bool(layers & _names(child)) or tag == "defs" or element.tag == "defs"
        if tag not in _SHAPES and tag not in _GROUPS:
            element.remove(child)
            if tag not in _SILENT and tag not in _UNDRAWN:
                left[_NAMES.get(tag, f"<{clean(tag, 30)}>")] += 1
        elif _is_hidden(child):
            element.remove(child)
            left["hidden"] += 1
        elif tag in (*_SHAPES, "use") and not inside:
            element.remove(child)
            left["in other layers"] += 1
        else:
            if tag == "use":
                _check_reference(path, child)
            if tag in ("a", "switch"):
                child.tag = "g"
            _prune(path, child, left, layers, chosen=inside)


def _names(element: ET.Element) -> set[str]:
    return {element.get(key, "") for key in ("label", "id")} - {""}


def _is_hidden(element: ET.Element) -> bool:
    style = dict(pair.split(":", 1) for pair in element.get("style", "").replace(" ", "").split(";") if ":" in pair)
    return style.get("display", element.get("display", "")) == "none"


def _check_layers(path: Path, root: ET.Element, layers: list[str]) -> None:
    groups = [item for item in root.iter("g") if _names(item)]
    missing = set(layers) - {name for item in groups for name in _names(item)}
    if missing:
        listed = ", ".join(sorted({clean(item.get("label") or item.get("id", ""), 40) for item in groups})[:12])
        what = f"it has no layer '{clean(min(missing), 60)}'"
        raise unusable(path, what, f"its layers and groups are {listed}" if listed else "leave out --layer")


def _check_reference(path: Path, use: ET.Element) -> None:
    """Refuse an element that uses another file."""
    address = (use.get("href") or "").strip()
    if address and not address.startswith("#"):
        what = f"it refers to '{clean(address, 100)}', and nothing outside of the file is read"
        raise unusable(path, what, "put what it refers to into the file, such as by saving it as plain SVG")


def _check_uses(path: Path, root: ET.Element) -> None:
    """Refuse elements that are used so often that there are too many shapes, or that use themselves."""
    known = {item.get("id", ""): item for item in root.iter()}
    counts: dict[str, int] = {}
    open_names: set[str] = set()

    def count(element: ET.Element) -> int:
        total = 0
        for item in element.iter():
            total += 1
            name = (item.get("href") or "")[1:]
            if item.tag != "use" or name not in known:
                continue
            if name in open_names:
                raise unusable(path, f"'{clean(name, 60)}' uses itself")
            if name not in counts:
                open_names.add(name)
                counts[name] = count(known[name])
                open_names.discard(name)
            total += counts[name]
        if total > _MAX_ELEMENTS:
            raise unusable(path, f"it draws more than {_MAX_ELEMENTS:,} shapes", "keep only the walls")
        return total

    count(root)
