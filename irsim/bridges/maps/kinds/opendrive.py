"""``opendrive``: roads of ASAM OpenDRIVE (``.xodr``): lanes for vehicles, or for pedestrians, are free."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from irsim.bridges.maps.grid import Ints, Triangles
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Kind, SceneTriangles, unusable
from irsim.bridges.maps.xml_files import read_xml
from irsim.common.arrays import Floats

__all__ = ["KIND", "Road", "lane_triangles", "read_roads"]

_STEP = 0.5
"""Distance between two cross sections of a road [m]; an arc of 10 m radius differs from its chord by 3 mm."""
_MAX_LENGTH = 1e6
"""Length of one road [m]."""
_SPIRAL_STEP = 0.02
"""Step of the integration of a spiral [m]; the midpoint rule is then exact to micrometers."""


@dataclass
class Geometry:
    """A piece of a reference line: where it begins, its length and heading, its shape and the numbers of the shape."""

    s: float
    x: float
    y: float
    heading: float
    length: float
    shape: str
    numbers: dict[str, float]
    normalized: bool = False


@dataclass
class Lane:
    """A lane: its number (left of the reference line above 0), its type and its width as cubics (s, a, b, c, d)."""

    number: int
    kind: str
    widths: Floats
    borders: Floats


@dataclass
class Road:
    """A road.

    Attributes:
        name: Its id.
        length: Its length [m].
        geometries: Pieces of its reference line.
        elevations, offsets: Heights, and offsets of the lanes from the reference line, as rows s, a, b, c, d.
        sections: For each section: where it begins [m], and its lanes.
    """

    name: str
    length: float
    geometries: list[Geometry]
    elevations: Floats
    offsets: Floats
    sections: list[tuple[float, list[Lane]]] = field(default_factory=list)


def read_roads(path: Path, limits: ImportLimits | None = None) -> Iterator[Road]:
    """Roads of a file, one after the other.

    Raises:
        BridgeError: The file is damaged, or has a value that is not a number.
    """
    root = read_xml(path, limits or ImportLimits())
    for element in root.iterfind("road"):
        yield _road(path, element)


def _road(path: Path, element: ET.Element) -> Road:
    name = element.get("id", "?")[:50]
    road = Road(
        name,
        _number(path, element, "length", name),
        [_geometry(path, item, name) for item in element.iterfind("planView/geometry")],
        _cubics(path, element.iterfind("elevationProfile/elevation"), name, "s"),
        _cubics(path, element.iterfind("lanes/laneOffset"), name, "s"),
    )
    if not 0 <= road.length <= _MAX_LENGTH:
        raise unusable(path, f"road {name} has a length of {road.length:g} m")
    for section in element.iterfind("lanes/laneSection"):
        lanes = [_lane(path, item, name) for side in ("left", "right") for item in section.iterfind(f"{side}/lane")]
        road.sections.append((_number(path, section, "s", name), lanes))
    road.sections.sort(key=lambda section: section[0])
    road.geometries.sort(key=lambda geometry: geometry.s)
    return road


def _geometry(path: Path, element: ET.Element, name: str) -> Geometry:
    shape = next((item for item in element if item.tag in _SHAPES), None)
    if shape is None:
        raise unusable(path, f"road {name} has a geometry other than {', '.join(sorted(_SHAPES))}")
    numbers = {key: _number(path, shape, key, name) for key in _SHAPES[shape.tag]}
    s, x, y, heading, length = (_number(path, element, key, name) for key in ("s", "x", "y", "hdg", "length"))
    if not 0 <= length <= _MAX_LENGTH:
        raise unusable(path, f"road {name} has a geometry of {length:g} m")
    return Geometry(s, x, y, heading, length, shape.tag, numbers, shape.get("pRange", "normalized") != "arcLength")


def _lane(path: Path, element: ET.Element, name: str) -> Lane:
    widths = _cubics(path, element.iterfind("width"), name, "sOffset")
    borders = _cubics(path, element.iterfind("border"), name, "sOffset")
    number = _number(path, element, "id", name)
    return Lane(int(number), element.get("type", "none"), widths, borders)


def _cubics(path: Path, elements: Iterator[ET.Element], name: str, start: str) -> Floats:
    rows = [[_number(path, item, key, name) for key in (start, "a", "b", "c", "d")] for item in elements]
    table = np.array(rows, dtype=np.float64).reshape(-1, 5)
    return table[np.argsort(table[:, 0], kind="stable")]


def _number(path: Path, element: ET.Element, key: str, road: str) -> float:
    text = element.get(key)
    try:
        value = float(text) if text is not None else math.nan
    except ValueError:
        value = math.nan
    if not math.isfinite(value) or abs(value) > 1e12:
        given = "is missing" if text is None else f"is '{text[:50]}'"
        raise unusable(path, f"the attribute {key} of <{element.tag}> in road {road} {given}, and must be a number")
    return value


def _value(table: Floats, s: Floats) -> Floats:
    """Cubics at s; zero before the first."""
    if not len(table):
        return np.zeros_like(s)
    row = np.searchsorted(table[:, 0], s + 1e-9, side="right") - 1
    start, a, b, c, d = table[np.maximum(row, 0)].T
    d_s = s - start
    return np.where(row >= 0, a + d_s * (b + d_s * (c + d_s * d)), 0.0)


def _line(geometry: Geometry, s: Floats) -> tuple[Floats, Floats, Floats]:
    return s, np.zeros_like(s), np.zeros_like(s)


def _arc(geometry: Geometry, s: Floats) -> tuple[Floats, Floats, Floats]:
    bend = geometry.numbers["curvature"]
    turn = s * bend
    if abs(bend) < 1e-12:
        return _line(geometry, s)
    return np.sin(turn) / bend, (1 - np.cos(turn)) / bend, turn


def _spiral(geometry: Geometry, s: Floats) -> tuple[Floats, Floats, Floats]:
    start, end = geometry.numbers["curvStart"], geometry.numbers["curvEnd"]
    rate = (end - start) / max(geometry.length, 1e-12)
    count = min(max(int(geometry.length / _SPIRAL_STEP), 64), 1_000_000)
    ends = np.linspace(0.0, geometry.length, count + 1)
    middle = (ends[1:] + ends[:-1]) / 2
    turn = middle * (start + rate * middle / 2)
    width = geometry.length / count
    x = np.concatenate([[0.0], np.cumsum(np.cos(turn) * width)])
    y = np.concatenate([[0.0], np.cumsum(np.sin(turn) * width)])
    return np.interp(s, ends, x), np.interp(s, ends, y), s * (start + rate * s / 2)


def _poly3(geometry: Geometry, s: Floats) -> tuple[Floats, Floats, Floats]:
    a, b, c, d = (geometry.numbers[key] for key in "abcd")
    u = np.linspace(0.0, max(geometry.length, 1e-9), 1025)
    rise = b + u * (2 * c + u * 3 * d)
    u = _at_length(u, np.hypot(1.0, (rise[1:] + rise[:-1]) / 2) * np.diff(u), s)
    return u, a + u * (b + u * (c + u * d)), np.arctan(b + u * (2 * c + u * 3 * d))


def _param_poly3(geometry: Geometry, s: Floats) -> tuple[Floats, Floats, Floats]:
    n = geometry.numbers
    p = s / max(geometry.length, 1e-12) if geometry.normalized else s
    u, v = (n[f"a{k}"] + p * (n[f"b{k}"] + p * (n[f"c{k}"] + p * n[f"d{k}"])) for k in "UV")
    du, dv = (n[f"b{k}"] + p * (2 * n[f"c{k}"] + p * 3 * n[f"d{k}"]) for k in "UV")
    return u, v, np.arctan2(dv, du)


def _at_length(parameter: Floats, lengths: Floats, s: Floats) -> Floats:
    """The parameter at lengths along a curve whose pieces have these lengths."""
    return np.interp(s, np.concatenate([[0.0], np.cumsum(lengths)]), parameter)


_CURVES = {"line": _line, "arc": _arc, "spiral": _spiral, "poly3": _poly3, "paramPoly3": _param_poly3}
_SHAPES: dict[str, tuple[str, ...]] = {
    "line": (),
    "arc": ("curvature",),
    "spiral": ("curvStart", "curvEnd"),
    "poly3": ("a", "b", "c", "d"),
    "paramPoly3": ("aU", "bU", "cU", "dU", "aV", "bV", "cV", "dV"),
}


def reference_line(road: Road, s: Floats) -> tuple[Floats, Floats, Floats]:
    """x, y [m] and heading [rad] of the reference line at lengths s along it."""
    x, y, heading = np.zeros_like(s), np.zeros_like(s), np.zeros_like(s)
    starts = np.array([geometry.s for geometry in road.geometries])
    which: Ints = np.clip(np.searchsorted(starts, s + 1e-9, side="right") - 1, 0, None)
    for k in np.unique(which):
        geometry, here = road.geometries[k], which == k
        along, left, turn = _CURVES[geometry.shape](geometry, np.clip(s[here] - geometry.s, 0.0, geometry.length))
        c, n = math.cos(geometry.heading), math.sin(geometry.heading)
        x[here] = geometry.x + c * along - n * left
        y[here] = geometry.y + n * along + c * left
        heading[here] = geometry.heading + turn
    return x, y, heading


def lane_triangles(path: Path, road: Road) -> Iterator[tuple[str, Triangles]]:
    """Type and triangles (T, 3, 3) [m] of each lane of a road, section by section."""
    if not road.geometries:
        return
    ends = [start for start, _ in road.sections[1:]] + [road.length]
    joints = [geometry.s for geometry in road.geometries]
    for (start, lanes), end in zip(road.sections, ends, strict=True):
        end = min(end, road.length)
        if end - start < 1e-6:
            continue
        inner = [joint for joint in joints if start < joint < end]
        s = np.unique(np.concatenate([np.linspace(start, end, max(int((end - start) / _STEP), 1) + 1), inner]))
        x, y, heading = reference_line(road, s)
        height = _value(road.elevations, s)
        if not np.isfinite([x, y, height]).all():
            raise unusable(path, f"road {road.name} leaves all bounds")
        for sign in (1, -1):
            offset = _value(road.offsets, s)
            edge = np.zeros_like(s)
            for lane in sorted((lane for lane in lanes if lane.number * sign > 0), key=lambda lane: abs(lane.number)):
                if len(lane.widths):
                    outer = edge + np.maximum(_value(lane.widths, s - start), 0.0)
                else:
                    outer = np.maximum(np.abs(_value(lane.borders, s - start)), edge)
                yield lane.kind, _strip(x, y, heading, height, offset + sign * edge, offset + sign * outer)
                edge = outer


def _strip(x: Floats, y: Floats, heading: Floats, height: Floats, inner: Floats, outer: Floats) -> Triangles:
    """Triangles between two lines at signed distances to the left of a reference line."""
    sides = [np.column_stack([x - np.sin(heading) * t, y + np.cos(heading) * t, height]) for t in (inner, outer)]
    a, b = sides
    wide = np.abs(outer - inner) > 1e-6
    quads = wide[1:] | wide[:-1]
    first = np.stack([a[:-1], a[1:], b[1:]], axis=1)[quads]
    second = np.stack([a[:-1], b[1:], b[:-1]], axis=1)[quads]
    return np.concatenate([first, second])


DRIVE = frozenset({
    "driving", "bidirectional", "entry", "exit", "onRamp", "offRamp", "connectingRamp", "slipLane", "mwyEntry",
    "mwyExit", "taxi", "bus", "HOV", "parking",
})  # fmt: skip
"""Types of lanes for vehicles (OpenDRIVE 1.7, section 9.5); stop and shoulder are not among them."""
WALK = frozenset({"sidewalk", "walking", "biking"})
"""Types of lanes for pedestrians."""
_HEADROOM = 2.5
"""Roads whose heights differ by less are at one place [m]."""
_CLIMB = 0.3
"""Difference of height between lanes side by side that is one level [m]."""


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> SceneTriangles:
    """Lanes of all roads.

    Raises:
        BridgeError: The file is damaged, or has no lanes.
    """
    wanted = {"drive": DRIVE, "walk": WALK, "all": DRIVE | WALK}[options.lanes]
    free: list[Triangles] = []
    barred: list[Triangles] = []
    seen: set[str] = set()
    total = 0
    for road in read_roads(path, limits):
        for kind, triangles in lane_triangles(path, road):
            total += len(triangles)
            if total > limits.triangles:
                raise unusable(path, f"its lanes need more than {limits.triangles:,} triangles", "cut the road network")
            seen.add(kind)
            if kind in wanted:
                free.append(triangles)
            elif kind != "none":
                barred.append(triangles)
    if not sum(map(len, free)):
        listed = ", ".join(sorted(seen)) or "none"
        raise unusable(path, f"it has no lanes to {options.lanes}; its lanes are: {listed}", "try --lanes all")
    notes = [] if options.lanes == "all" else [f"free are lanes to {options.lanes}; others are occupied"]
    return SceneTriangles(
        "irsim",
        floors=np.concatenate(free),
        barred=np.concatenate(barred) if barred else np.zeros((0, 3, 3)),
        headroom=_HEADROOM,
        climb=_CLIMB,
        notes=notes,
    )


KIND = Kind(
    name="opendrive",
    title="a road network of OpenDRIVE",
    suffixes=(".xodr",),
    read=read,
    unused=("slope", "ground", "up", "rotate", "meters_per_unit", "opacity", "root"),
    roots=("OpenDRIVE",),
)
