"""Footprints and plans that libraries of other people write: GeoJSON, OpenStreetMap and DXF, three files of each."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity
import shapely.geometry

from tests.bridges.maps.occupied import assert_occupied

pytestmark = pytest.mark.interop
YARD = shapely.box(0, 0, 30, 20).difference(shapely.box(8, 6, 20, 14))
TOWER = shapely.Point(45, 10).buffer(6, quad_segs=16)
HOUSE = shapely.affinity.rotate(shapely.box(10, 30, 32, 40), 25)
AREA = sum(shape.area for shape in (YARD, TOWER, HOUSE))


def in_degrees(shape: Any) -> Any:
    """A shape near Zurich, in meters of UTM zone 32, as longitudes and latitudes, by PROJ."""
    pyproj = pytest.importorskip("pyproj")
    back = pyproj.Transformer.from_crs("EPSG:32632", "EPSG:4326", always_xy=True)
    moved = shapely.affinity.translate(shape, 500_000, 5_250_000)  # on the middle of the zone, where lengths are 0.9996
    return shapely.transform(moved, lambda points: np.column_stack(back.transform(*points.T)))


def test_geojson_of_geopandas(tmp_path: Path) -> None:
    geopandas = pytest.importorskip("geopandas")
    pytest.importorskip("pyogrio")
    moved = [shapely.affinity.translate(shape, 500_000, 5_250_000) for shape in (YARD, TOWER, HOUSE)]
    frame = geopandas.GeoDataFrame({"building": ["yes"] * 3}, geometry=moved, crs="EPSG:32632").to_crs("EPSG:4326")
    frame.to_file(tmp_path / "a.geojson", driver="GeoJSON")
    assert_occupied(tmp_path / "a.geojson", AREA / 0.9996**2)


def test_geojson_of_the_library_geojson(tmp_path: Path) -> None:
    geojson = pytest.importorskip("geojson")
    park = geojson.Feature(geometry=in_degrees(shapely.box(-50, -50, 90, 90)), properties={"leisure": "park"})
    made = [geojson.Feature(geometry=in_degrees(one), properties={"building": "house"}) for one in (YARD, HOUSE, TOWER)]
    (tmp_path / "a.json").write_text(geojson.dumps(geojson.FeatureCollection([park, *made])))
    assert_occupied(tmp_path / "a.json", AREA / 0.9996**2)


def test_geojson_of_shapely_as_a_plan(tmp_path: Path) -> None:
    walls = shapely.MultiLineString([[(0, 0), (10, 0), (10, 8)], [(4, 2), (4, 8)]])
    parts = shapely.GeometryCollection([walls, shapely.Point(7, 4).buffer(1)])
    (tmp_path / "a.geojson").write_text(json.dumps(shapely.geometry.mapping(parts)))
    assert_occupied(tmp_path / "a.geojson", (18 + 6) * 0.2 + 0.01 + math.pi, meters_per_unit=1.0)


@pytest.mark.parametrize("what", ["ways", "relation", "walls"])
def test_extracts_of_osmium(tmp_path: Path, what: str) -> None:
    osmium = pytest.importorskip("osmium")
    mutable = osmium.osm.mutable
    nodes: list[Any] = []
    ways: list[Any] = []

    def way(line: Any, tags: dict[str, str]) -> None:
        points = shapely.get_coordinates(in_degrees(line))
        closed = bool((points[0] == points[-1]).all())
        first = len(nodes) + 1
        for x, y in points[: len(points) - closed]:
            nodes.append(mutable.Node(id=len(nodes) + 1, location=(x, y), version=1))
        numbers = list(range(first, len(nodes) + 1)) + [first] * closed
        ways.append(mutable.Way(id=len(ways) + 1, nodes=numbers, tags=tags, version=1))

    relations, scale = [], 0.9996
    if what == "ways":
        way(HOUSE.exterior, {"building": "yes", "name": "Hall"})
        way(TOWER.exterior, {"building": "tower"})
        way(shapely.box(-60, -60, 90, 90).exterior, {"landuse": "residential"})
        area = HOUSE.area + TOWER.area
    elif what == "relation":
        way(YARD.exterior, {})
        way(YARD.interiors[0], {})
        members = [("w", 1, "outer"), ("w", 2, "inner")]
        tags = {"type": "multipolygon", "building": "yes"}
        relations.append(mutable.Relation(id=1, members=members, tags=tags, version=1))
        area = YARD.area
    else:
        way(shapely.LineString([(0, 0), (20, 0)]), {"barrier": "wall", "width": "0.5"})
        way(shapely.LineString([(0, 10), (0, 30)]), {"barrier": "fence"})
        way(shapely.LineString([(5, 10), (50, 30)]), {"highway": "footway"})
        area, scale = (20 * 0.5 + 20 * 0.2), scale**0.5
    with osmium.SimpleWriter(str(tmp_path / "a.osm")) as writer:
        for node in nodes:
            writer.add_node(node)
        for one in ways:
            writer.add_way(one)
        for one in relations:
            writer.add_relation(one)
    assert_occupied(tmp_path / "a.osm", area / scale**2)


def test_a_plan_of_the_r12_writer_of_ezdxf(tmp_path: Path) -> None:
    r12writer = pytest.importorskip("ezdxf.addons.r12writer").r12writer
    with r12writer(str(tmp_path / "a.dxf")) as plan:
        plan.add_polyline_2d([(0, 0), (10, 0), (10, 8), (0, 8)], closed=True, layer="walls")
        plan.add_polyline_2d([(0.3, 0.3), (9.7, 0.3), (9.7, 7.7), (0.3, 7.7)], closed=True, layer="walls")
        plan.add_line((4, 0.3), (4, 5), layer="inner")
        plan.add_circle((7, 3), radius=0.5, layer="columns")
        plan.add_text("Hall", (1, 1))
    walls = 80 - 9.4 * 7.4
    assert_occupied(tmp_path / "a.dxf", walls + 4.7 * 0.2 + math.pi * 0.25)


def test_a_plan_of_ezdxf_with_curves_and_layers(tmp_path: Path) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    plan = ezdxf.new("R2018", units=ezdxf.units.CM)
    for name in ("solid", "furniture", "off"):
        plan.layers.add(name)
    plan.layers.get("off").off()
    space = plan.modelspace()
    space.add_ellipse((300, 300), (200, 0), 0.5, dxfattribs={"layer": "solid"})
    space.add_arc((900, 300), 200, 0, 90, dxfattribs={"layer": "solid"})
    space.add_lwpolyline([(0, 600, 1), (200, 600, 1)], format="xyb", close=True, dxfattribs={"layer": "furniture"})
    space.add_circle((500, 500), 100, dxfattribs={"layer": "off"})
    plan.saveas(tmp_path / "a.dxf")
    solid = math.pi * 2 * 1 + math.pi / 2 * 2 * 0.2
    assert_occupied(tmp_path / "a.dxf", solid + math.pi)
    assert_occupied(tmp_path / "a.dxf", solid, layers=("Solid",))
