"""``geojson``: footprints in GeoJSON: polygons, and lines as walls; in degrees, or in units of a plan."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import shapely
import shapely.affinity
import shapely.geometry

from irsim.bridges.maps.geographic import WALL, are_degrees, in_meters
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Kind, Outlined, Outlines, unusable
from irsim.common.records import ContentError, read_json
from irsim.common.text import clean, plural

__all__ = ["KIND"]

_HEAD = re.compile(rb'"type"\s*:\s*"(FeatureCollection|Feature|GeometryCollection|(Multi)?(Polygon|LineString))"')
_SOLID = ("building", "barrier", "wall")
"""Properties of what stands in the way, as OpenStreetMap has them."""


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> Outlines:
    """Outlines of the polygons and lines of a file.

    Raises:
        BridgeError: The file is damaged, or its coordinates are neither degrees nor in a unit that was given.
    """
    try:
        data = read_json(path, most_bytes=limits.bytes)
    except ContentError as error:
        raise unusable(path, error.message) from None
    things, notes = _chosen(path, _features(path, data))
    unit = options.meters_per_unit
    if unit is not None:
        things = [replace(t, region=shapely.affinity.scale(t.region, unit, unit, origin=(0, 0))) for t in things]
    elif not are_degrees([thing.region for thing in things]):
        fix = "write it in WGS 84, or give --meters-per-unit 1 if its coordinates are meters"
        raise unusable(path, "its coordinates are not longitudes and latitudes", fix)
    else:
        things, said = in_meters(path, things)
        notes += said
    solid = [replace(thing, region=_solid(thing.region)) for thing in things]
    return Outlines(solid, meters_per_unit=1.0 if unit is None else unit, notes=notes)


def _features(path: Path, data: Any) -> list[dict[str, Any]]:
    """The features of a file, which may be a geometry alone."""
    kind = data.get("type") if isinstance(data, dict) else None
    features = data.get("features") if kind == "FeatureCollection" else [data]
    if kind not in ("FeatureCollection", "Feature"):
        features = [{"geometry": data, "properties": None}]
    if not isinstance(features, list) or not all(isinstance(item, dict) for item in features):
        raise unusable(path, "its features are not a list of objects")
    return features


def _chosen(path: Path, features: list[dict[str, Any]]) -> tuple[list[Outlined], list[str]]:
    """Obstacles, in the units of the file, and notes about features that were left out."""
    marked = [item for item in features if _is_marked(item)]
    notes = []
    if marked and len(marked) < len(features):
        notes.append(f"left out: {len(features) - len(marked)} features that are neither building nor barrier")
    things, points = [], 0
    for number, item in enumerate(marked or features):
        geometry = item.get("geometry")
        if geometry is None:
            continue
        region = _region(path, geometry, number)
        parts = [part for part in _parts(region) if part.geom_type in ("Polygon", "LineString", "LinearRing")]
        points += not parts
        properties = item.get("properties")
        name = properties.get("name") if isinstance(properties, dict) else None
        things += [Outlined(clean(name, 80) if isinstance(name, str) else "", part) for part in parts]
    if points:
        notes.append(f"left out: {plural(points, 'feature')} without an area or a line")
    return things, notes


def _is_marked(feature: dict[str, Any]) -> bool:
    """Whether its properties say that it is a building or a barrier."""
    properties = feature.get("properties")
    return isinstance(properties, dict) and any(properties.get(key) not in (None, "no", False) for key in _SOLID)


def _region(path: Path, geometry: Any, number: int) -> Any:
    """The geometry of a feature."""
    try:
        region = shapely.force_2d(shapely.geometry.shape(geometry))
    except (ValueError, TypeError, KeyError, IndexError, AttributeError, shapely.errors.ShapelyError):
        raise unusable(path, f"the geometry of feature {number} is wrong") from None
    if not np.isfinite(shapely.get_coordinates(region)).all():
        raise unusable(path, f"the geometry of feature {number} is not finite")
    return region


def _parts(region: Any) -> list[Any]:
    """Polygons, lines and points of a geometry, in all depths."""
    if hasattr(region, "geoms"):
        return [part for inner in region.geoms for part in _parts(inner)]
    return [] if region.is_empty else [region]


def _solid(region: Any) -> Any:
    """The area of a polygon, or of a wall along a line [m]."""
    if region.geom_type == "Polygon":
        return shapely.make_valid(region)
    return region.buffer(WALL / 2, cap_style="flat", join_style="mitre")


KIND = Kind(
    name="geojson",
    title="a file of GeoJSON",
    suffixes=(".geojson",),
    accepts=lambda head: _HEAD.search(head) is not None,
    read=read,
    unknown="free",
    unused=("headroom", "slope", "ground", "climb", "up", "rotate", "level", "height", "opacity", "lanes", "root"),
)
