"""Maps as obstacles: exact shapes, the area of the file, and a scenario that runs."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest
import shapely
import yaml
from typer.testing import CliRunner

import irsim
from irsim import api
from irsim.bridges.base import BridgeError
from irsim.bridges.maps import import_map
from irsim.bridges.maps.entries import entries_of
from irsim.bridges.maps.source import Outlined
from irsim.cli.app import app
from irsim.diagnostics.errors import ArgumentError

WORLD = """<sdf version="1.9"><world name="w">
  <model name="table"><static>1</static><pose>2 3 0.5 0 0 0.5</pose><link name="l">
    <collision name="top"><geometry><box><size>2 1 1</size></box></geometry></collision>
    <collision name="board"><geometry><box><size>1.5 0.8 1</size></box></geometry></collision></link></model>
  <model name="post"><static>1</static><pose>6 3 0.5 0 0 0</pose><link name="l"><collision name="c">
    <geometry><cylinder><radius>0.4</radius><length>1</length></cylinder></geometry></collision></link></model>
  <model name="ball"><static>1</static><pose>8 6 0.8 0 0 0</pose><link name="l"><collision name="c">
    <geometry><sphere><radius>0.5</radius></sphere></geometry></collision></link></model>
  </world></sdf>"""


def shapes(lines: list[str]) -> list[dict]:
    return yaml.safe_load("\n".join(lines)) or []


def union_of(file: Path) -> float:
    env = irsim.make(str(file), display=False)
    return shapely.union_all([obstacle.geometry for obstacle in env.obstacle_list]).area


def test_a_world_of_gazebo_becomes_obstacles_that_a_robot_passes() -> None:
    Path("a.sdf").write_text(WORLD)
    result = import_map("a.sdf", "a.yaml", obstacles=True, robot=True)
    assert result.files == ["a.yaml", "a.bridge.json"]
    assert result.obstacles == 3
    assert "left out: 1 outline within another one, which stands there as well" in result.notes
    table, post, ball = yaml.safe_load(Path("a.yaml").read_text())["obstacle"]
    assert table["shape"] == {"name": "rectangle", "length": 2.0, "width": 1.0}
    assert table["state"] == [2.0, 3.0, 0.5]
    assert post == {"shape": {"name": "circle", "radius": 0.4}, "state": [6.0, 3.0, 0.0]}
    assert ball["shape"] == {"name": "circle", "radius": pytest.approx(0.5, abs=2e-3)}
    assert "# table/top" in Path("a.yaml").read_text()
    assert union_of(Path("a.yaml")) == pytest.approx(2 + math.pi * (0.16 + 0.25), rel=0.01)
    assert api.validate("a.yaml", strict=True).valid
    assert api.run("a.yaml", seed=1).outcome == "success"


def test_holes_are_cut_and_small_outlines_are_left_out() -> None:
    yard = shapely.box(0, 0, 10, 8).difference(shapely.union_all([shapely.box(x, 1, x + 2, 7) for x in (1, 4, 7)]))
    crumb = shapely.box(20, 0, 20.005, 0.005)
    lines, notes = entries_of([Outlined("yard\n- evil", yard), Outlined("", crumb)])
    drawn = [entry["shape"] for entry in shapes(lines)]
    assert all(shape["name"] in ("polygon", "rectangle") for shape in drawn)
    pieces = [shapely.Polygon(shape["vertices"]).area for shape in drawn if shape["name"] == "polygon"]
    pieces += [shape["length"] * shape["width"] for shape in drawn if shape["name"] == "rectangle"]
    assert sum(pieces) == pytest.approx(yard.area)
    assert notes == [
        "left out: 1 outline smaller than 1 cm²",
        "cut into pieces, as obstacles have no holes: 1 outline",
    ]


@pytest.mark.parametrize("corners", [3, 4, 5, 8, 12, 40])
def test_regular_polygons_of_many_corners_are_disks(corners: int) -> None:
    points = [(3 + math.cos(2 * math.pi * k / corners), math.sin(2 * math.pi * k / corners)) for k in range(corners)]
    (entry,) = shapes(entries_of([Outlined("", shapely.Polygon(points))])[0])
    assert entry["shape"]["name"] == {4: "rectangle", 12: "circle", 40: "circle"}.get(corners, "polygon")


def test_what_obstacles_cannot_be_made_of_is_said(monkeypatch) -> None:
    square = [[0, 0], [9, 0], [9, 9], [0, 9], [0, 0]]
    places = [[[[x + 10 * k, y] for x, y in square]] for k in range(12)]
    Path("a.geojson").write_text(json.dumps({"type": "MultiPolygon", "coordinates": places}))
    assert import_map("a.geojson", "a.yaml", meters_per_unit=1, obstacles=True).obstacles == 12
    with pytest.raises(ArgumentError, match="radius changes cells"):
        import_map("a.geojson", "b.yaml", meters_per_unit=1, obstacles=True, radius=0.2)
    Path("m.yaml").write_text(
        "image: m.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.6\nfree_thresh: 0.2\n"
    )
    Path("m.pgm").write_bytes(b"P5 4 4 255\n" + b"\xff" * 15 + b"\0")
    with pytest.raises(ArgumentError, match="no outlines"):
        import_map("m.yaml", "b.yaml", obstacles=True)
    monkeypatch.setattr("irsim.bridges.maps.entries._MAX_OBSTACLES", 10)
    with pytest.raises(BridgeError, match="more than 10 obstacles"):
        import_map("a.geojson", "b.yaml", meters_per_unit=1, obstacles=True)
    assert not Path("b.yaml").exists()


def test_the_command_says_how_many_obstacles_it_wrote() -> None:
    Path("a.sdf").write_text(WORLD)
    done = CliRunner().invoke(app, ["map", "import", "a.sdf", "-o", "a.yaml", "--obstacles"])
    assert "3 obstacles" in done.output
