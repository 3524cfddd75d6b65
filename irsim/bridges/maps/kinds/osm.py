"""``osm``: extracts of OpenStreetMap in XML (``.osm``): footprints of buildings, and walls and fences."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path
from typing import Any

import shapely

from irsim.bridges.maps.geographic import WALL, in_meters
from irsim.bridges.maps.source import NOT_FLAT, ImportLimits, ImportOptions, Kind, Outlined, Outlines, unusable
from irsim.bridges.maps.xml_files import read_xml
from irsim.common.text import clean, plural

__all__ = ["KIND"]

_BARRIERS = ("wall", "city_wall", "retaining_wall", "fence", "hedge", "guard_rail", "jersey_barrier")
_OPEN = ("no", "roof", "carport")
"""Buildings that one walks under."""

Point = tuple[float, float]


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> Outlines:
    """Outlines of buildings and barriers.

    Raises:
        BridgeError: The file is damaged.
    """
    root = read_xml(path, limits)
    nodes = {node.get("id", ""): _place(path, node) for node in root.iterfind("node") if node.get("lat") is not None}
    ways: dict[str, list[Point]] = {}
    things: list[Outlined] = []
    widths: list[float] = []
    cut = 0
    for way in root.iterfind("way"):
        tags = _tags(way)
        refs = [nd.get("ref", "") for nd in way.iterfind("nd")]
        line = [nodes[ref] for ref in refs if ref in nodes]
        ways[way.get("id", "")] = line if len(line) == len(refs) else []
        building, barrier = _is_building(tags), tags.get("barrier") in _BARRIERS
        if not (building or barrier):
            continue
        closed = len(line) >= 4 and line[0] == line[-1]
        whole = len(line) == len(refs) and (closed if building else len(line) >= 2)
        cut += not whole
        if whole:
            area = building or (closed and tags.get("area") == "yes")
            shape = shapely.Polygon(line) if area else shapely.LineString(line)
            things.append(Outlined(clean(tags.get("name", ""), 80), shape))
            widths.append(_width(tags))
    for relation in root.iterfind("relation"):
        tags = _tags(relation)
        if tags.get("type") != "multipolygon" or not _is_building(tags):
            continue
        region = _rings(relation, ways, "outer").difference(_rings(relation, ways, "inner"))
        cut += region.is_empty
        if not region.is_empty:
            things.append(Outlined(clean(tags.get("name", ""), 80), region))
            widths.append(WALL)
    placed, notes = in_meters(path, things)
    if cut:
        notes.append(f"left out: {plural(cut, 'outline')} of which the file has only a part")
    solid = [replace(t, region=_solid(t.region, width)) for t, width in zip(placed, widths, strict=True)]
    return Outlines(solid, notes=notes)


def _place(path: Path, node: ET.Element) -> Point:
    """Longitude and latitude of a node [degrees]."""
    try:
        longitude, latitude = float(node.get("lon", "")), float(node.get("lat", ""))
    except ValueError:
        longitude, latitude = math.nan, math.nan
    if not (abs(longitude) <= 180 and abs(latitude) <= 90):
        raise unusable(path, f"node {clean(node.get('id', '?'), 50)} has no longitude and latitude")
    return longitude, latitude


def _tags(element: ET.Element) -> dict[str, str]:
    return {tag.get("k", ""): tag.get("v", "") for tag in element.iterfind("tag")}


def _is_building(tags: dict[str, str]) -> bool:
    return tags.get("building", "no") not in _OPEN


def _width(tags: dict[str, str]) -> float:
    """Thickness of a wall [m]."""
    try:
        width = float(tags.get("width", "").removesuffix("m"))
    except ValueError:
        return WALL
    return width if 0 < width < 100 else WALL


def _rings(relation: ET.Element, ways: dict[str, list[Point]], role: str) -> Any:
    """The area inside the members of a role, whose ways are parts of rings."""
    members = [item for item in relation.iterfind("member") if (item.get("role") or "outer") == role]
    lines = [ways.get(item.get("ref", ""), []) for item in members if item.get("type") == "way"]
    usable = [shapely.LineString(line) for line in lines if len(line) >= 2]
    return shapely.union_all(list(shapely.polygonize(usable).geoms))


def _solid(region: Any, width: float) -> Any:
    """The area of a building, or of a wall along a line [m]."""
    if region.geom_type == "LineString":
        return region.buffer(width / 2, cap_style="flat", join_style="mitre")
    return shapely.make_valid(region)


KIND = Kind(
    name="osm",
    title="an extract of OpenStreetMap",
    suffixes=(".osm",),
    read=read,
    unknown="free",
    unused=NOT_FLAT,
    roots=("osm",),
)
