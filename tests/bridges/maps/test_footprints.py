"""Footprints of GeoJSON and OpenStreetMap: areas in meters, what is left out, and wrong files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import shapely

from irsim.bridges.base import BridgeError
from irsim.bridges.maps import import_map
from irsim.bridges.maps.kinds import geojson, osm
from irsim.bridges.maps.source import ImportLimits, ImportOptions

EAST, NORTH = 1 / 111_319.4908, 1 / 110_574.2758
"""Degrees of a meter at the equator, on the ellipsoid of WGS 84."""


def box(x: float, y: float, wide: float, high: float) -> list[list[float]]:
    corners = [(x, y), (x + wide, y), (x + wide, y + high), (x, y + high), (x, y)]
    return [[9 + a * EAST, b * NORTH] for a, b in corners]


def feature(kind: str, coordinates: Any, **properties: Any) -> dict[str, Any]:
    return {"type": "Feature", "properties": properties, "geometry": {"type": kind, "coordinates": coordinates}}


def write(*features: Any) -> Path:
    file = Path("a.geojson")
    file.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    return file


def occupied(file: Path, **options: Any) -> float:
    result = import_map(file, "a.yaml", overwrite=True, **options)
    return result.occupied * result.resolution**2


def test_footprints_have_their_area_in_meters() -> None:
    yard = feature("Polygon", [box(-20, -10, 20, 20), box(-15, -5, 10, 10)])
    two = feature("MultiPolygon", [[box(5, 0, 4, 3)], [box(12, 0, 4, 3)]])
    wall = feature("LineString", [[9.0, 15 * NORTH], [9 + 10 * EAST, 15 * NORTH]])
    file = write(yard, two, wall, feature("Point", [9, 0]))
    matches = geojson.read(file, ImportOptions(), ImportLimits())
    assert [thing.region.area for thing in matches.things] == pytest.approx([300, 12, 12, 2], rel=1e-4)
    assert any("transverse Mercator" in note for note in matches.notes)
    assert "left out: 1 feature without an area or a line" in matches.notes
    assert occupied(file) == pytest.approx(326, rel=0.01)


def test_lengths_far_from_the_equator() -> None:
    degree = feature("Polygon", [[[10, 60], [10.001, 60], [10.001, 60.001], [10, 60.001], [10, 60]]])
    matches = geojson.read(write(degree), ImportOptions(), ImportLimits())
    left, lower, right, upper = matches.things[0].region.bounds
    assert right - left == pytest.approx(55.80, abs=0.01)
    assert upper - lower == pytest.approx(111.41, abs=0.01)


def test_buildings_are_chosen_where_features_say_what_they_are() -> None:
    park = feature("Polygon", [box(0, 0, 50, 50)], leisure="park")
    file = write(park, feature("Polygon", [box(0, 0, 10, 5)], building="yes"))
    assert occupied(file) == pytest.approx(50, rel=0.01)


def test_a_unit_makes_it_a_plan() -> None:
    plan = feature("Polygon", [[[0, 0], [400000, 0], [400000, 200000], [0, 200000], [0, 0]]])
    with pytest.raises(BridgeError, match="not longitudes and latitudes"):
        import_map(write(plan), "a.yaml")
    assert occupied(write(plan), meters_per_unit=1e-5) == pytest.approx(8, rel=0.01)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('{"type": "FeatureCollection", "features": [', "not valid JSON"),
        ('{"type": "FeatureCollection", "features": 3}', "not a list"),
        ('{"type": "FeatureCollection", "features": []}', "nothing stands"),
        ('{"type": "Polygon", "coordinates": [[[0, 0], [1, 1]]]}', "geometry of feature 0"),
        ('{"type": "Polygon", "coordinates": "here"}', "geometry of feature 0"),
        ('{"type": "Polygon", "coordinates": [[[0, 0], [9, 0], [9, 9], [0, 0]]]}', "100 km"),
        ("[]", "as its name says"),
        ("", "empty"),
    ],
)
def test_wrong_geojson_is_refused(text, message) -> None:
    Path("a.geojson").write_text(text)
    with pytest.raises(BridgeError, match=message):
        import_map("a.geojson", "a.yaml")
    assert not Path("a.yaml").exists()


class Extract:
    """An extract of OpenStreetMap that is being written."""

    def __init__(self) -> None:
        self.nodes: list[str] = []
        self.items: list[str] = []

    def way(self, points: list[list[float]], **tags: str) -> str:
        refs = []
        for longitude, latitude in points:
            node = f'<node id="{len(self.nodes)}" lon="{longitude:.12f}" lat="{latitude:.12f}"/>'
            refs.append(len(self.nodes))
            self.nodes.append(node)
        if points[0] == points[-1]:
            refs[-1] = refs[0]
        inside = "".join(f'<nd ref="{ref}"/>' for ref in refs)
        self.items.append(f'<way id="{len(self.items)}">{inside}{tags_of(tags)}</way>')
        return str(len(self.items) - 1)

    def relation(self, members: dict[str, str], **tags: str) -> None:
        inside = "".join(f'<member type="way" ref="{ref}" role="{role}"/>' for ref, role in members.items())
        self.items.append(f'<relation id="r">{inside}{tags_of(tags)}</relation>')

    def write(self) -> Path:
        file = Path("a.osm")
        file.write_text(f'<osm version="0.6">{"".join(self.nodes + self.items)}</osm>')
        return file


def tags_of(tags: dict[str, str]) -> str:
    return "".join(f'<tag k="{key}" v="{value}"/>' for key, value in tags.items())


def test_buildings_and_walls_of_an_extract() -> None:
    extract = Extract()
    extract.way(box(0, 0, 10, 5), building="house", name="Hall")
    extract.way(box(0, 10, 10, 5), building="roof")
    extract.way(box(-50, -50, 100, 100), landuse="grass")
    extract.way([[9.0, -5 * NORTH], [9 + 20 * EAST, -5 * NORTH]], barrier="wall", width="0.5 m")
    extract.way([[9.0, -8 * NORTH], [9 + 20 * EAST, -8 * NORTH]], highway="footway")
    outer, inner = extract.way(box(30, 0, 10, 10)), extract.way(box(33, 3, 4, 4))
    extract.relation({outer: "outer", inner: "inner"}, type="multipolygon", building="yes")
    extract.items.append('<way id="x"><nd ref="0"/><nd ref="gone"/><tag k="building" v="yes"/></way>')
    matches = osm.read(extract.write(), ImportOptions(), ImportLimits())
    assert [thing.region.area for thing in matches.things] == pytest.approx([50, 10, 84], rel=1e-4)
    assert matches.things[0].name == "Hall"
    assert "left out: 1 outline of which the file has only a part" in matches.notes
    area = shapely.union_all([thing.region for thing in matches.things]).area
    assert occupied(Path("a.osm")) == pytest.approx(area, rel=0.01)


@pytest.mark.parametrize(
    ("inside", "message"),
    [
        ("<node id='4' lat='north' lon='1'/>", "node 4 has no longitude and latitude"),
        ("<node id='4' lat='nan' lon='1'/>", "node 4 has no longitude and latitude"),
        ("<node", "damaged"),
        ("", "nothing stands"),
    ],
)
def test_wrong_extracts_are_refused(inside, message) -> None:
    Path("a.osm").write_text(f"<osm>{inside}</osm>")
    with pytest.raises(BridgeError, match=message):
        import_map("a.osm", "a.yaml")
