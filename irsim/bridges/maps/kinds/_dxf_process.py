"""The process that reads DXF with ezdxf: the lines of its model space, blocks and curves as lines, too."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import ezdxf
import ezdxf.path
import ezdxf.units
import numpy as np
from ezdxf.disassemble import recursive_decompose

from irsim.bridges.maps.apart import Refused, serve
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


def load(path: Path, request: dict[str, Any]) -> tuple[Floats, dict[str, Any]]:
    """Points of all lines, and what is known of each line.

    Args:
        path: The file.
        request: The request of the parent process.

    Returns:
        (K, 3) number of the line, x and y; and ``parts``, for each line its group, whether it is closed, and its width.
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
    return np.array(rows, dtype=np.float64).reshape(-1, 3), {"parts": parts, "unit": unit, "notes": notes}


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
