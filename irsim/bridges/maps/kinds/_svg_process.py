"""The process that reads SVG with svgelements: the areas of what it paints, in the order in which it paints them.

svgelements gets only elements that draw: text, pictures, scripts and references to other files are taken away before.
"""

from __future__ import annotations

import io
import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from svgelements import SVG, Close, Color, Line, Move, Shape
from svgelements import Path as Curve

from irsim.bridges.maps.apart import Refused, serve
from irsim.bridges.maps.areas import packed
from irsim.bridges.maps.kinds._svg_areas import Clips, painted_region, visible
from irsim.bridges.maps.kinds._svg_clips import CLIP, CLIPPED, UNREAD
from irsim.bridges.maps.kinds._svg_tree import cleaned
from irsim.bridges.maps.source import ImportLimits
from irsim.bridges.maps.xml_files import read_xml
from irsim.common.arrays import Floats
from irsim.common.text import plural

__all__ = ["load", "main"]

_PIXEL = 0.0254 / 96
"""Length of a pixel of CSS [m]."""
_FLAT = 0.002
"""Distance of lines from curves [m]."""
_LEAST, _MOST_PIECES = 12, 512
"""Lines that a piece of a curve becomes."""
_MOST = 2_000_000
"""Points of all outlines."""
_WHITE = 0.9
"""Brightness above which paint is the ground and no obstacle."""
_FAINT = 0.1
"""Opacity below which paint is not seen."""
_AGAIN = "write the file again with the program that made it"
_FARTHEST = 1e9
"""Largest coordinate [m]."""
_SMALL = 2.0
"""Size below which a drawing is on a scale rather than as large as the place [m]."""


def main() -> None:
    """Read the request, answer it."""
    serve(load)


def load(path: Path, request: dict[str, Any]) -> tuple[Any, dict[str, Any]]:
    """Outlines of what stands in the way, as :func:`~irsim.bridges.maps.areas.packed` makes them.

    Args:
        path: The file.
        request: The request of the parent process; ``unit`` is the length of a unit of the drawing [m] or None,
            ``layers`` are the names of the layers that count, or None for all.

    Returns:
        The outlines in meters, y up, without what white paint covers or clip paths cut off; the length of a unit, and
        remarks.
    """
    tree = cleaned(path, read_xml(path, ImportLimits(bytes=request["bytes"]), doctypes=True), request["layers"])
    root, notes = tree.root, list(tree.notes)
    unit, scaled = request["unit"], request["unit"] is not None
    if root.get("viewBox") and (scaled or not _has_length(root)):
        for key in ("width", "height"):
            root.attrib.pop(key, None)
    drawing = SVG.parse(io.BytesIO(ET.tostring(root)), reify=False, ppi=96, parse_display_none=True)
    if not isinstance(drawing, SVG):
        raise Refused("it draws nothing", "give a drawing with shapes")
    size = _size(drawing, root)
    if not scaled:
        unit = _PIXEL
        notes += _unit_notes(root, size, drawing)
    regions, paints = _painted(drawing, _Scale(unit, 0.0 if size is None else size[1]))
    light = sum(not paint.dark for paint in paints)
    if light:
        notes.append(f"{light} area{'s' * (light != 1)} in white or nearly white count as free ground")
    notes += _unread(regions, paints)
    things = visible(regions, np.array([paint.dark for paint in paints], bool), [paint.name for paint in paints])
    if not things:
        raise Refused("nothing in it is painted darker than white", "check its layers, colors and hidden parts")
    data, answer = packed(things)
    return data, answer | {"unit": unit * _pixels_per_unit(drawing, size), "notes": notes}


@dataclass(frozen=True)
class _Scale:
    """From pixels to meters: the length of a pixel [m], and the height of the drawing [pixels]."""

    unit: float
    height: float

    def meters(self, line: list[tuple[float, float]]) -> Floats:
        points = np.array(line, dtype=np.float64)
        points[:, 1] = self.height - points[:, 1]
        points *= self.unit
        if not (np.abs(points) <= _FARTHEST).all():
            raise Refused("it has coordinates beyond a million kilometers", "give --meters-per-unit")
        return points


@dataclass(frozen=True)
class _Paint:
    name: str
    dark: bool
    unread: bool


def _painted(drawing: Any, scale: _Scale) -> tuple[list[Any], list[_Paint]]:
    """The areas that are painted, in their order, and what is known of each."""
    regions: list[Any] = []
    paints: list[_Paint] = []
    clips = Clips()
    total = 0
    for shape in drawing.elements(lambda element: isinstance(element, Shape)):
        values = shape.values
        if values.get("display") == "none" or values.get("visibility") in ("hidden", "collapse"):
            continue
        if CLIP in values:
            lines = [scale.meters(line) for line in _lines(shape, scale.unit) if len(line) >= 3]
            if lines:
                clips.add(values[CLIP], painted_region(lines, str(values.get("clip-rule", "nonzero"))))
            continue
        if _share(values.get("opacity")) < _FAINT:
            continue
        name = str(values.get("label") or values.get("id") or "")[:80]
        numbers = [key.removeprefix(CLIPPED) for key in values if str(key).startswith(CLIPPED)]
        points = None
        for what in ("fill", "stroke"):
            width = float(shape.implicit_stroke_width or 0.0) if what == "stroke" else 0.0
            dark = _is_dark(str(values.get(what, "none")), _share(values.get(f"{what}-opacity")))
            if dark is None or (what == "stroke" and not 0 < width * scale.unit < 1e6):
                continue
            points = _lines(shape, scale.unit) if points is None else points
            kept = [scale.meters(line) for line in points if len(line) >= (3 if what == "fill" else 2)]
            if not kept:
                continue
            total += sum(map(len, kept))
            _check_number(total)
            rule = str(values.get("fill-rule", "nonzero")) if what == "fill" else "line"
            cap, join = str(values.get("stroke-linecap", "butt")), str(values.get("stroke-linejoin", "miter"))
            region = painted_region(kept, rule, width * scale.unit, cap, join)
            regions.append(clips.cut(numbers, region) if numbers else region)
            paints.append(_Paint(name, dark, UNREAD in values))
    return regions, paints


def _unread(regions: list[Any], paints: list[_Paint]) -> list[str]:
    """A remark on the share of paint that has a clip path or a mask which is not read."""
    areas = shapely.area(np.array(regions, dtype=object))
    wrong = np.array([paint.unread for paint in paints], bool)
    if not wrong.any():
        return []
    share = areas[wrong].sum() / max(areas.sum(), 1e-12)
    what = "what masks and clip paths in other units cut off is part of the map"
    return [f"{what}: {plural(int(wrong.sum()), 'area')}, {share:.1%} of what is painted"]


def _check_number(points: int) -> None:
    if points > _MOST:
        raise Refused(f"its outlines have more than {_MOST:,} points", "leave out layers that are not walls")


def _share(text: Any) -> float:
    """An opacity."""
    try:
        value = float(str(text).rstrip("%")) / (100 if str(text).endswith("%") else 1)
    except ValueError:
        return 1.0
    return min(max(value, 0.0), 1.0) if math.isfinite(value) else 1.0


def _is_dark(paint: str, opacity: float) -> bool | None:
    """Whether paint stands in the way, rather than being white ground; None where nothing is seen."""
    if paint.lower() in ("none", "transparent", "") or opacity < _FAINT:
        return None
    if paint.lower().startswith(("url(", "context-", "inherit")):
        return True  # hatches and gradients
    color = Color(paint)
    if color.value is None:
        return True
    alpha = opacity * color.opacity
    if alpha < _FAINT:
        return None
    brightness = (0.2126 * color.red + 0.7152 * color.green + 0.0722 * color.blue) / 255
    if alpha * brightness + (1 - alpha) < _WHITE:
        return True
    return False if alpha > 0.5 else None


def _lines(shape: Any, unit: float) -> list[list[tuple[float, float]]]:
    """Lines of a shape in pixels, y down; closed ones end where they begin."""
    curve = Curve(shape)
    curve.reify()
    result: list[list[tuple[float, float]]] = []
    total = 0
    for piece in curve:
        if isinstance(piece, Move) or not result:
            if piece.end is None:
                continue
            result.append([(float(piece.end.x), float(piece.end.y))])
            if isinstance(piece, Move):
                continue
        if isinstance(piece, (Line, Close)):
            if piece.end is not None:
                result[-1].append((float(piece.end.x), float(piece.end.y)))
            if isinstance(piece, Close) and piece.end is not None:
                result.append([(float(piece.end.x), float(piece.end.y))])
            continue
        length = float(np.hypot(*np.diff(piece.npoint(np.linspace(0, 1, 5)), axis=0).T).sum()) * unit
        if not math.isfinite(length):
            raise Refused("it has coordinates that are not finite", _AGAIN)
        count = min(max(_LEAST, math.ceil(math.sqrt(0.3 * min(length, 1e6) / _FLAT))), _MOST_PIECES)
        total += count
        _check_number(total)
        result[-1] += [(x, y) for x, y in piece.npoint(np.linspace(0, 1, count + 1)[1:]).tolist()]
    for line in result:
        if not all(map(math.isfinite, (x for point in line for x in point))):
            raise Refused("it has coordinates that are not finite", _AGAIN)
    return result


def _has_length(root: ET.Element) -> bool:
    """Whether the drawing says how large it is."""
    return bool(root.get("width") and root.get("height")) and "%" not in f"{root.get('width')}{root.get('height')}"


def _size(drawing: Any, root: ET.Element) -> tuple[float, float] | None:
    """Width and height of the drawing in pixels; None if it does not say."""
    if not (root.get("viewBox") or _has_length(root)):
        return None
    size = float(drawing.width), float(drawing.height)
    if not all(0 < value < 1e12 for value in size):
        raise Refused("its width and height are not positive", "give it a width, a height and a viewBox")
    return size


def _pixels_per_unit(drawing: Any, size: tuple[float, float] | None) -> float:
    """Length of a unit of the view box in pixels."""
    box = drawing.viewbox
    return 1.0 if size is None or box is None or not box.width else size[0] / float(box.width)


def _unit_notes(root: ET.Element, size: tuple[float, float] | None, drawing: Any) -> list[str]:
    """Remarks on the size of the drawing."""
    width = (root.get("width") or "").strip().lower()
    known = _has_length(root) and width.endswith(("mm", "cm", "in", "pt", "pc", "q"))
    shown = "" if size is None else f", so that the drawing is {size[0] * _PIXEL:.3g} m x {size[1] * _PIXEL:.3g} m"
    fix = "--meters-per-unit gives the length of a unit of the drawing"
    if not known:
        return [f"the drawing has no length in mm, cm or in: a unit is a pixel of 1/96 inch{shown}; {fix}"]
    if size is None or max(size) * _PIXEL >= _SMALL:
        return []
    units = _PIXEL * _pixels_per_unit(drawing, size)
    paper = f"the drawing is {size[0] * _PIXEL:.3g} m x {size[1] * _PIXEL:.3g} m, as on paper"
    return [f"{paper}; for a scale of 1:100 give --meters-per-unit {100 * units:.4g}"]


if __name__ == "__main__":
    main()
