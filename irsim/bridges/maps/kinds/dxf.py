"""``dxf``: floor plans in DXF, read in a process of its own: closed outlines and hatches are solid, lines are walls."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import shapely

from irsim.bridges.maps.apart import read_apart
from irsim.bridges.maps.areas import nested
from irsim.bridges.maps.geographic import WALL
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Kind, Outlined, Outlines, unusable

__all__ = ["KIND"]


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> Outlines:
    """Outlines of the model space.

    Raises:
        BridgeError: The file is damaged.
    """
    rows, said = read_apart(
        path, f"{__package__}._dxf_process", limits, {"layers": options.layers and list(options.layers)}
    )
    unit = options.meters_per_unit or float(said["unit"])
    points = np.asarray(rows, dtype=np.float64)
    if not np.isfinite(points).all():
        raise unusable(path, "it has coordinates that are not finite")
    lines = np.split(points[:, 1:] * unit, np.searchsorted(points[:, 0], range(1, len(said["parts"]))))
    groups: dict[str, list[Any]] = {}
    things: list[Outlined] = []
    for line, (group, closed, width) in zip(lines, said["parts"], strict=True):
        if closed and len(line) >= 4:
            groups.setdefault(group, []).append(shapely.make_valid(shapely.Polygon(line)))
        elif len(line) >= 2:
            thick = width * unit if width > 0 else WALL
            wall = shapely.LineString(line).buffer(thick / 2, cap_style="flat", join_style="mitre")
            things.append(Outlined("", wall))
    for regions in groups.values():
        things.append(Outlined("", nested(regions)))
    return Outlines(things, meters_per_unit=unit, notes=list(said["notes"]))


KIND = Kind(
    name="dxf",
    title="a plan in DXF",
    suffixes=(".dxf",),
    accepts=lambda head: b"SECTION" in head,
    read=read,
    unknown="free",
    extra="plans",
    libraries=("ezdxf",),
    unused=("headroom", "slope", "ground", "climb", "up", "rotate", "level", "height", "opacity", "lanes", "root"),
    by_name=True,
    layered=True,
)
