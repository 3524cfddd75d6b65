"""The process that reads DXF with ezdxf: the areas of its model space, of lines, closed outlines and hatches."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import ezdxf
import ezdxf.path
import ezdxf.units
import numpy as np
import shapely
from ezdxf.disassemble import recursive_decompose

from irsim.bridges.maps.apart import Refused, serve
from irsim.bridges.maps.areas import nested, packed
from irsim.bridges.maps.geographic import WALL
from irsim.bridges.maps.source import Outlined
from irsim.common.arrays import Floats

__all__ = ["load", "main"]

_DRAWN = ("LINE", "LWPOLYLINE", "POLYLINE", "CIRCLE", "ARC", "ELLIPSE", "SPLINE", "SOLID", "TRACE", "3DFACE")
_FLAT = 0.002
"""Distance of lines from curves [m]."""
_MOST = 2_000_000
"""Points of all lines."""


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
        The outlines in meters, the length of a unit, and remarks.
    """
    document = ezdxf.readfile(path)
    notes = [] if document.units else ["the file names no unit: meters were taken, --meters-per-unit gives another one"]
    unit = float(ezdxf.units.conversion_factor(document.units or ezdxf.units.M, ezdxf.units.M))
    hidden = {layer.dxf.name for layer in document.layers if layer.is_off() or layer.is_frozen()}
    chosen = _chosen(document, request["layers"])
    rows: list[tuple[float, float, float]] = []
    parts: list[tuple[str, bool, float]] = []
    left: Counter[str] = Counter()
    for number, entity in enumerate(recursive_decompose(document.modelspace())):
        kind = entity.dxftype()
        if chosen is not None and entity.dxf.layer.lower() not in chosen:
            left["in other layers"] += 1
        elif entity.dxf.layer in hidden:
            left["hidden"] += 1
        elif kind in ("HATCH", "MPOLYGON"):
            for line in ezdxf.path.from_hatch(entity):
                _add(rows, parts, line, (f"hatch {number}", True, 0.0), unit)
        elif kind in _DRAWN:
            width = float(entity.dxf.get("const_width", 0.0)) if kind == "LWPOLYLINE" else 0.0
            for line in ezdxf.path.make_path(entity).sub_paths():
                _add(rows, parts, line, (entity.dxf.layer, bool(line.is_closed), width), unit)
        else:
            left[kind] += 1
    if left:
        listed = ", ".join(f"{count} {kind}" for kind, count in left.most_common(5))
        notes.append(f"left out, since they are neither lines nor areas that are seen: {listed}")
    unit = request["unit"] or unit
    data, answer = packed(_things(np.array(rows, dtype=np.float64).reshape(-1, 3), parts, unit))
    return data, answer | {"unit": unit, "notes": notes}


def _things(points: Floats, parts: list[tuple[str, bool, float]], unit: float) -> list[Outlined]:
    """Walls of lines, and the areas of closed outlines, of which one within another one of its layer is a hole.

    Args:
        points: (K, 3) number of the line, x and y.
        parts: For each line its group, whether it is closed, and its width.
        unit: Length of a unit [m].
    """
    if not np.isfinite(points).all():
        raise Refused("it has coordinates that are not finite")
    lines = np.split(points[:, 1:] * unit, np.searchsorted(points[:, 0], range(1, len(parts))))
    groups: dict[str, list[Any]] = {}
    things: list[Outlined] = []
    for line, (group, closed, width) in zip(lines, parts, strict=True) if parts else ():
        if closed and len(line) >= 4:
            groups.setdefault(group, []).append(shapely.make_valid(shapely.Polygon(line)))
        elif len(line) >= 2:
            thick = width * unit if width > 0 else WALL
            wall = shapely.LineString(line).buffer(thick / 2, cap_style="flat", join_style="mitre")
            things.append(Outlined("", wall))
    return things + [Outlined("", nested(regions)) for regions in groups.values()]


def _chosen(document: Any, layers: list[str] | None) -> set[str] | None:
    """Names of the layers that count, in lower case, as DXF does not tell cases apart; None for all."""
    if layers is None:
        return None
    known = {layer.dxf.name.lower(): layer.dxf.name for layer in document.layers}
    missing = [name for name in layers if name.lower() not in known]
    if missing:
        raise Refused(
            f"it has no layer '{missing[0][:60]}'", f"its layers are {', '.join(sorted(known.values())[:12])}"
        )
    return {name.lower() for name in layers}


def _add(rows: list[Any], parts: list[Any], line: Any, part: tuple[str, bool, float], unit: float) -> None:
    """Add a line."""
    number = float(len(parts))
    rows += [(number, point.x, point.y) for point in line.flattening(_FLAT / unit)]
    if len(rows) > _MOST:
        raise Refused(f"its lines have more than {_MOST:,} points", "leave out layers that are not walls")
    parts.append(part)


if __name__ == "__main__":
    main()
