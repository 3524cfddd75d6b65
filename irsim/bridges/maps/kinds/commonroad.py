"""``commonroad``: scenarios of CommonRoad (``.xml``): static obstacles; roads, if there are any, are what is free."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import shapely
import shapely.affinity

from irsim.bridges.maps.source import NOT_FLAT, ImportLimits, ImportOptions, Kind, Outlined, Outlines, unusable
from irsim.bridges.maps.xml_files import find_number, read_xml
from irsim.common.arrays import Floats
from irsim.common.text import plural

__all__ = ["KIND"]

_QUARTER_SEGMENTS = 16


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> Outlines:
    """Outlines of static obstacles, and the area of all lanelets.

    Raises:
        BridgeError: The file is damaged, or a number is missing.
    """
    root = read_xml(path, limits)
    things: list[Outlined] = []
    moving = 0
    for item in root:
        still = item.tag == "staticObstacle" or (item.findtext("role") or "").strip() == "static"
        moving += item.tag == "dynamicObstacle" or (item.tag == "obstacle" and not still)
        if still:
            things += [Outlined(item.get("id", ""), region) for region in _placed(path, item)]
    lanes = [_lanelet(path, item) for item in root.iterfind("lanelet") if item.find("leftBound") is not None]
    notes = [f"left out: {plural(moving, 'obstacle')} that can move"] if moving else []
    return Outlines(things, free=shapely.union_all(lanes) if lanes else None, notes=notes)


def _points(path: Path, element: ET.Element) -> Floats:
    """(K, 2) points of an element [m]."""
    rows = [(find_number(path, point, "x"), find_number(path, point, "y")) for point in element.iterfind("point")]
    return np.array(rows, dtype=np.float64).reshape(-1, 2)


def _lanelet(path: Path, element: ET.Element) -> Any:
    bounds = [_points(path, side) for name in ("leftBound", "rightBound") for side in element.iterfind(name)]
    if len(bounds) != 2 or min(map(len, bounds)) < 2:
        raise unusable(path, f"lanelet {element.get('id', '?')[:50]} has no two bounds of two points")
    return shapely.make_valid(shapely.Polygon(np.concatenate([bounds[0], bounds[1][::-1]])))


def _placed(path: Path, obstacle: ET.Element) -> Iterator[Any]:
    """Areas of the shapes of an obstacle where it stands [m]."""
    name = obstacle.get("id", "?")[:50]
    state = obstacle.find("initialState")
    places = [] if state is None else list(state.iterfind("position/point"))
    if state is None or not places:
        raise unusable(path, f"obstacle {name} has no exact initial position")
    turn = find_number(path, state, "orientation/exact", 0.0)
    x, y = find_number(path, places[0], "x"), find_number(path, places[0], "y")
    for shape in obstacle.iterfind("shape/*"):
        region = _shape(path, shape, name)
        region = shapely.affinity.rotate(region, turn, origin=(0, 0), use_radians=True)
        yield shapely.affinity.translate(region, x, y)


def _shape(path: Path, shape: ET.Element, name: str) -> Any:
    """Area of a shape in the frame of its obstacle [m]."""
    center = shape.find("center")
    x, y = (0.0, 0.0) if center is None else (find_number(path, center, "x"), find_number(path, center, "y"))
    if shape.tag == "circle":
        return shapely.Point(x, y).buffer(find_number(path, shape, "radius"), quad_segs=_QUARTER_SEGMENTS)
    if shape.tag in ("rectangle", "truckShape"):
        sides = shape.find("truckDims") if shape.tag == "truckShape" else shape
        sides = shape if sides is None else sides
        length, width = find_number(path, sides, "length"), find_number(path, sides, "width")
        x -= find_number(path, shape, "originXShift", 0.0)
        box = shapely.box(x - length / 2, y - width / 2, x + length / 2, y + width / 2)
        return shapely.affinity.rotate(box, find_number(path, shape, "orientation", 0.0), use_radians=True)
    corners = _points(path, shape)
    if shape.tag != "polygon" or len(corners) < 3:
        raise unusable(path, f"obstacle {name} has a shape other than rectangles, circles, polygons and trucks")
    return shapely.make_valid(shapely.Polygon(corners))


KIND = Kind(
    name="commonroad",
    title="a scenario of CommonRoad",
    suffixes=(),
    read=read,
    unused=NOT_FLAT,
    roots=("commonRoad",),
)
