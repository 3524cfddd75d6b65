"""``svg``: floor plans in SVG, read in a process of its own: dark paint stands in the way, white is ground."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

import numpy as np
import shapely

from irsim.bridges.maps.apart import read_apart
from irsim.bridges.maps.areas import filled, nested
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Kind, Outlined, Outlines, unusable
from irsim.common.arrays import Floats

__all__ = ["KIND"]

_CAPS: dict[str, Literal["flat", "round", "square"]] = {"butt": "flat", "round": "round", "square": "square"}
_JOINS: dict[str, Literal["mitre", "round", "bevel"]] = {"miter": "mitre", "round": "round", "bevel": "bevel"}


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> Outlines:
    """Outlines of what is painted, as one sees it: what is white covers what was painted before.

    Raises:
        BridgeError: The file is damaged, or refers to another one.
    """
    request = {"unit": options.meters_per_unit, "layers": options.layers and list(options.layers)}
    rows, said = read_apart(path, f"{__package__}._svg_process", limits, request)
    points = np.asarray(rows, dtype=np.float64)
    if not (np.abs(points) <= 1e9).all():
        raise unusable(path, "it has coordinates beyond a million kilometers", "give --meters-per-unit")
    ends = np.searchsorted(points[:, 0], range(1, len(said["parts"])))
    lines: list[list[Floats]] = [[] for _ in said["paints"]]
    for line, paint in zip(np.split(points[:, 1:], ends), said["parts"], strict=True) if len(points) else ():
        lines[paint].append(line)
    regions = [_region(some, paint) for some, paint in zip(lines, said["paints"], strict=True)]
    dark = np.array([bool(paint[1]) for paint in said["paints"]], bool)
    things = _seen(regions, dark, [paint[0] for paint in said["paints"]])
    if not things:
        raise unusable(path, "nothing in it is painted darker than white", "check its layers, colors and hidden parts")
    return Outlines(things, meters_per_unit=float(said["unit"]), notes=list(said["notes"]))


def _region(lines: list[Floats], paint: list[Any]) -> Any:
    """The area of paint [m]."""
    _, _, rule, width, cap, join = paint
    if rule == "evenodd":
        return nested([shapely.make_valid(shapely.Polygon(line)) for line in lines])
    if rule != "line":
        return filled(lines)
    walls = shapely.MultiLineString([line for line in lines if np.ptp(line, axis=0).any()])
    rings = [shapely.LinearRing(line) for line in lines if len(line) > 3 and (line[0] == line[-1]).all()]
    ends, corners = _CAPS.get(cap, "flat"), _JOINS.get(join, "mitre")
    parts = [walls, *rings]  # a closed line has no ends
    return shapely.union_all(shapely.buffer(parts, width / 2, cap_style=ends, join_style=corners, mitre_limit=4.0))


def _seen(regions: list[Any], dark: Any, names: list[str]) -> list[Outlined]:
    """The parts of dark paint that light paint, which came later, leaves visible."""
    light = np.flatnonzero(~dark)
    tree = shapely.STRtree([regions[k] for k in light])
    things = []
    for number in np.flatnonzero(dark):
        above = light[tree.query(regions[number], predicate="intersects")]
        above = above[above > number]
        region = regions[number]
        if len(above):
            region = region.difference(shapely.union_all([regions[k] for k in above]))
        if region.area > 0:
            things.append(Outlined(names[number], region))
    return things


KIND = Kind(
    name="svg",
    title="a plan in SVG",
    suffixes=(".svg",),
    accepts=lambda head: False,  # it is known by its root element
    read=read,
    unknown="free",
    extra="plans",
    libraries=("svgelements",),
    unused=("headroom", "slope", "ground", "climb", "up", "level", "height", "opacity", "lanes", "root"),
    roots=("svg",),
    layered=True,
)
