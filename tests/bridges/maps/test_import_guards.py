"""Imports of maps: parts of scenes, options that say nothing, files that stay, maps without room."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely

from irsim.bridges.base import BridgeError
from irsim.bridges.maps import import_map
from irsim.bridges.maps.grid import clipped
from irsim.common.files import TargetError
from irsim.diagnostics.errors import ArgumentError
from tests.bridges.maps.navmesh_files import TWO_ROOMS, UPSTAIRS, mesh_set, tile


@pytest.fixture
def scene(tmp_path) -> Path:
    file = tmp_path / "flat.navmesh"
    file.write_bytes(mesh_set(tile(TWO_ROOMS), tile(UPSTAIRS)))
    return file


def test_cut_triangles_keep_their_area_and_face_the_same_way() -> None:
    rng = np.random.default_rng(3)
    triangles = rng.uniform(-3, 3, (400, 3, 3))
    bounds = (-1.0, -0.5, 1.5, 2.0)
    cut = clipped(triangles, bounds)
    assert cut[..., 0].min() >= -1 - 1e-9
    assert cut[..., 1].max() <= 2 + 1e-9
    window = shapely.box(*bounds)
    inside = [shapely.Polygon(one[:, :2]).intersection(window).area for one in triangles]
    ups = []
    for part in (triangles, cut):
        ab, ac = part[:, 1] - part[:, 0], part[:, 2] - part[:, 0]
        ups.append((ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]) / 2)
    assert np.abs(ups[1]).sum() == pytest.approx(sum(inside))
    assert ups[1].sum() == pytest.approx(float(np.sign(ups[0]) @ inside))


def test_options_that_say_nothing_about_a_file_are_refused(scene, tmp_path) -> None:
    (tmp_path / "road.xodr").write_text("<OpenDRIVE/>")
    for name, file in (("headroom", scene), ("up", scene), ("opacity", scene), ("slope", tmp_path / "road.xodr")):
        with pytest.raises(ArgumentError, match=f"the option {name} says nothing about .* Fix: leave out --{name}"):
            import_map(file, tmp_path / "a.yaml", **{name: "y" if name == "up" else 0.3})
    import_map(scene, tmp_path / "a.yaml", ros_map=tmp_path / "map.yaml")
    with pytest.raises(ArgumentError, match="the option resolution says nothing about the YAML file"):
        import_map(tmp_path / "map.yaml", tmp_path / "b.yaml", resolution=0.1)


def test_what_a_map_is_made_from_is_not_overwritten(scene, tmp_path) -> None:
    import_map(scene, tmp_path / "a.yaml", ros_map=tmp_path / "map.yaml")
    (tmp_path / "map.pgm").rename(tmp_path / "picture.png")
    text = (tmp_path / "map.yaml").read_text().replace("map.pgm", "picture.png")
    (tmp_path / "map.yaml").write_text(text)
    for name in ("map.yaml", "picture.yaml"):
        with pytest.raises(TargetError, match="is what the map is made from"):
            import_map(tmp_path / "map.yaml", tmp_path / name, overwrite=True)
    assert (tmp_path / "map.yaml").read_text() == text
    assert not (tmp_path / "picture.yaml").exists()


def test_a_map_without_room(scene, tmp_path) -> None:
    with pytest.raises(BridgeError, match="no room for a robot"):
        import_map(scene, tmp_path / "a.yaml", robot=True, radius=8)
    assert "no cell is free" in import_map(scene, tmp_path / "a.yaml", radius=8).notes


def test_a_picture_that_is_missing_is_a_key_of_the_map(tmp_path) -> None:
    (tmp_path / "map.yaml").write_text("image: nope.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n")
    with pytest.raises(BridgeError, match=r"nope\.pgm'\. Fix: correct the key image"):
        import_map(tmp_path / "map.yaml", tmp_path / "a.yaml")


def test_roads_that_declare_entities_are_refused_in_one_sentence(tmp_path) -> None:
    road = tmp_path / "road.xodr"
    road.write_text('<!DOCTYPE r [<!ENTITY a "b">]><OpenDRIVE/>')
    with pytest.raises(BridgeError) as caught:
        import_map(road, tmp_path / "a.yaml")
    assert str(caught.value).count("cannot be imported") == 1
