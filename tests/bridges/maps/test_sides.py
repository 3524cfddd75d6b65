"""The side of the cells: chosen and said where a map would be too large, for every kind of file."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from irsim.bridges.base import BridgeError
from irsim.bridges.maps import import_map
from irsim.bridges.maps.grid import SIDES
from irsim.bridges.maps.source import ImportLimits
from irsim.bridges.maps.voxels import few_pieces
from irsim.cli.app import app
from tests.bridges.maps import test_commonroad as roads_of_scenarios
from tests.bridges.maps import test_footprints as footprints
from tests.bridges.maps import test_roads as roads
from tests.bridges.maps.scenes import TWO_ROOMS, box, mesh_set, tile
from tests.bridges.splats.scenes import room, write_ply

SMALL = ImportLimits(cells=4_000)


def _written(name: str, text: str) -> Path:
    Path(name).write_text(text)
    return Path(name)


def _navmesh() -> Path:
    Path("a.navmesh").write_bytes(mesh_set(tile(TWO_ROOMS)))
    return Path("a.navmesh")


WORLD = """<sdf version="1.7"><world name="w"><model name="m"><static>true</static><link name="l"><collision name="c">
<geometry><box><size>9 7 2</size></box></geometry></collision></link></model></world></sdf>"""
MODEL = '<mujoco><worldbody><geom type="box" size="4 3 1"/></worldbody></mujoco>'
PLACES = """<osm version="0.6"><node id="1" lat="0" lon="9"/><node id="2" lat="0" lon="9.0002"/>
<node id="3" lat="0.0002" lon="9.0002"/><way id="4"><nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="1"/>
<tag k="building" v="yes"/></way></osm>"""
FILES: dict[str, Callable[[], Path]] = {
    "navmesh": _navmesh,
    "sdf": lambda: _written("a.sdf", WORLD),
    "mjcf": lambda: _written("a.xml", MODEL),
    "opendrive": lambda: roads.write(roads.road("<line/>", 40)),
    "commonroad": lambda: roads_of_scenarios.write(roads_of_scenarios.obstacle(roads_of_scenarios.BOX, 40, 5)),
    "geojson": lambda: footprints.write(footprints.feature("Polygon", [footprints.box(0, 0, 20, 20)])),
    "osm": lambda: _written("a.osm", PLACES),
    "splats": lambda: write_ply(Path("a.ply"), room(spacing=0.1).columns),
}


@pytest.mark.parametrize("kind", FILES)
def test_the_side_that_fits_is_chosen_and_said(kind: str) -> None:
    file = FILES[kind]()
    result = import_map(file, "b.yaml", limits=SMALL)
    assert result.kind == kind
    assert result.resolution in SIDES[1:]
    assert result.columns * result.rows <= SMALL.cells
    assert f"cells are {result.resolution:g} m, so that the map is not too large" in " ".join(result.notes)
    with pytest.raises(BridgeError, match="--resolution"):
        import_map(file, "c.yaml", resolution=0.05, limits=SMALL)
    same = import_map(file, "c.yaml", resolution=result.resolution, limits=SMALL)
    assert (same.columns, same.rows) == (result.columns, result.rows)
    assert not [note for note in same.notes if note.startswith("cells are")]


def test_usual_cells_need_no_words() -> None:
    result = import_map(FILES["navmesh"](), "b.yaml")
    assert result.resolution == 0.05
    assert "cells are" not in " ".join(result.notes)


def test_the_command_says_the_side_in_its_answer() -> None:
    footprints.write(footprints.feature("Polygon", [footprints.box(0, 0, 200, 200)]))
    words = ["map", "import", "a.geojson", "-o", "b.yaml"]
    shown = CliRunner().invoke(app, words)
    assert " cells of 0.1 m" in shown.output
    assert "cells are 0.1 m, so that the map is not too large" in shown.output
    answer = CliRunner().invoke(app, [*words, "--force", "--json"])
    assert json.loads(answer.stdout)["resolution"] == 0.1


def test_scenes_of_many_large_triangles_get_larger_cells() -> None:
    ground = box([0, 0, 0], [100, 100, 0.1])
    assert few_pieces(ground, 0.05)
    assert not few_pieces(ground.repeat(40, axis=0), 0.05)
    assert few_pieces(ground.repeat(40, axis=0), 0.2)
