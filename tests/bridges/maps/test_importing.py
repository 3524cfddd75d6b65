"""The import as a whole: kinds of files, what is written, what is refused, and the command."""

from __future__ import annotations

import hashlib
import importlib.util
import json
import os
import zipfile
from pathlib import Path

import numpy as np
import pytest
import shapely
import yaml
from PIL import Image
from typer.testing import CliRunner

from irsim import api
from irsim.bridges.base import BridgeError
from irsim.bridges.maps import import_map, list_levels, read_sidecar
from irsim.bridges.maps.grid import clipped
from irsim.bridges.maps.source import ImportLimits, find_kind, kinds
from irsim.cli.app import app
from irsim.common.extras import ExtraError
from irsim.common.files import TargetError
from irsim.diagnostics.errors import ArgumentError
from irsim.scenario.read import read
from tests.bridges.maps.scenes import TWO_ROOMS, UPSTAIRS, box, mesh_set, tile, write_glb, write_obj


@pytest.fixture
def scene() -> Path:
    file = Path("flat.navmesh")
    file.write_bytes(mesh_set(tile(TWO_ROOMS), tile(UPSTAIRS)))
    return file


def names() -> list[str]:
    return sorted(path.name for path in Path().iterdir())


def test_a_run_follows_at_once(scene) -> None:
    result = import_map(scene, "flat.yaml", robot=True)
    assert names() == ["flat.bridge.json", "flat.navmesh", "flat.png", "flat.yaml"]
    assert api.validate("flat.yaml", strict=True).valid
    assert api.run("flat.yaml", seed=1).outcome == "success"
    assert result.trip is not None
    assert result.trip.clearance >= 0.3
    sidecar = read_sidecar("flat.yaml")
    digest = hashlib.sha256(scene.read_bytes()).hexdigest()
    assert (sidecar.source["sha256"], sidecar.source["file"]) == (digest, "flat.navmesh")
    assert sidecar.size == (result.columns, result.rows)


def test_a_map_for_ros_keeps_what_is_unknown(scene) -> None:
    import_map(scene, "a.yaml", ros_map="map.yaml")
    meta = yaml.safe_load(Path("map.yaml").read_text())
    assert meta["image"] == "map.pgm"
    for unknown in ("free", "occupied"):
        back = import_map("map.yaml", f"{unknown}.yaml", unknown=unknown)
        first = import_map(scene, f"{unknown}-2.yaml", unknown=unknown)
        a, b = (read(Path(f"{unknown}{end}.yaml")).scenario.grid.cells.occupied for end in ("", "-2"))
        assert (a == b).all()
        assert back.unknown == first.unknown > 0
        assert back.origin == pytest.approx(first.origin)


def test_a_seed_point_of_a_map_of_ros(scene) -> None:
    file = Path("rooms.navmesh")
    file.write_bytes(mesh_set(tile(((0, 0, 3, 3, 0), (4, 0, 6, 3, 0)))))
    import_map(file, "a.yaml", ros_map="map.yaml", seed_point=(1.0, 1.0))
    small = import_map(file, "small.yaml", seed_point=(5.0, 1.0))
    assert "6.0 m²; the largest part has 9.0 m²" in small.notes[-1]
    one = import_map("map.yaml", "b.yaml", unknown="occupied")
    assert one.free_area == pytest.approx(9, rel=0.02)
    with pytest.raises(BridgeError, match="not free") as caught:
        import_map("map.yaml", "c.yaml", seed_point=(5.0, 1.0))
    assert caught.value.code == "bridge-file"


def test_the_radius_is_taken_away(scene) -> None:
    free = import_map(scene, "a.yaml").free_area
    assert import_map(scene, "b.yaml", radius=0.2).free_area < free - 3
    assert read_sidecar("b.yaml").agent["radius"] == 0.2


def test_files_are_all_written_or_none(scene, monkeypatch) -> None:
    Path("flat.png").write_text("mine")
    with pytest.raises(TargetError, match=r"flat\.png' exists"):
        import_map(scene, "flat.yaml")
    assert names() == ["flat.navmesh", "flat.png"]
    import_map(scene, "flat.yaml", overwrite=True)
    assert Path("flat.png").read_bytes()[:4] == b"\x89PNG"
    with pytest.raises(TargetError, match="same name"):
        import_map(scene, "x.yaml", ros_map="x.yaml")
    with pytest.raises(TargetError, match="suffixes"):
        import_map(scene, "x.json")
    written = []
    real = os.open

    def full(path, flags, mode=0o777, **options):
        if str(path).endswith("y.png"):
            raise OSError(28, "No space left on device", str(path))
        written.append(str(path))
        return real(path, flags, mode, **options)

    monkeypatch.setattr(os, "open", full)
    with pytest.raises(OSError, match="No space"):
        import_map(scene, "y.yaml")
    assert any(path.endswith("y.yaml") for path in written)
    assert not [name for name in names() if name.startswith("y.")]


def test_levels_are_listed_without_files(scene) -> None:
    result = list_levels(scene)
    assert [one.height for one in result.levels] == pytest.approx([0.1, 3.0])
    assert names() == ["flat.navmesh"]


def test_kinds_are_found_by_name_and_content(scene) -> None:
    assert {"mesh", "navmesh", "opendrive", "ros", "usd"} <= {kind.name for kind in kinds()}
    triangles = box([0, 0, 0], [1, 1, 1])
    assert find_kind(write_glb(Path("a.glb"), triangles)).name == "mesh"
    assert find_kind(write_obj(Path("a.obj"), triangles)).name == "mesh"
    bare = Path("no_suffix")
    bare.write_bytes(scene.read_bytes())
    assert find_kind(bare).name == "navmesh"
    for name, content, said in [
        ("a.txt", b"hello", "suffixes .dae, "),
        ("b.glb", b"hello", "not a mesh, as its name says"),
        ("c.glb", b"", "it is empty"),
        ("d.navmesh", b"\x89PNG", "not a navigation mesh"),
        ("e.usd", b"hello", "not a stage"),
        ("f.yaml", b"robot: []", "not the YAML file of a map"),
        ("none.glb", None, "cannot be read"),
    ]:
        if content is not None:
            Path(name).write_bytes(content)
        with pytest.raises(BridgeError, match=said) as caught:
            import_map(name, "x.yaml")
        assert caught.value.code == "bridge-file"
    places = [Path()]
    if hasattr(os, "mkfifo"):
        places.append("pipe.glb")
        os.mkfifo(places[-1])
    for place in places:
        with pytest.raises(BridgeError, match="no file"):
            import_map(place, "x.yaml")


def test_a_server_sets_limits(scene) -> None:
    inside = ImportLimits(root=str(Path().absolute()))
    assert import_map("flat.navmesh", "maps.yaml", limits=inside).files[0].endswith("maps.yaml")
    assert Path("maps.yaml").is_file()
    for file, out, ros in [
        ("../flat.navmesh", "a.yaml", None),
        ("/etc/passwd", "a.yaml", None),
        ("flat.navmesh", "../a.yaml", None),
        ("flat.navmesh", "a.yaml", "/tmp/b.yaml"),
    ]:
        with pytest.raises(BridgeError) as caught:
            import_map(file, out, ros_map=ros, limits=inside)
        assert caught.value.code == "path-outside-workspace"
    for limit, said in (
        (ImportLimits(bytes=100), "at most 100 are read"),
        (ImportLimits(cells=500), "--resolution"),
        (ImportLimits(triangles=3), "at most 3 are read"),
    ):
        with pytest.raises(BridgeError, match=said):
            import_map(scene, "a.yaml", resolution=0.05, limits=limit)
    Path("map.yaml").write_text("{image: ../x.pgm, resolution: 1, origin: [0, 0, 0]}")
    with pytest.raises(BridgeError) as wrong:
        import_map("map.yaml", "b.yaml", limits=inside)
    assert wrong.value.code == "path-outside-workspace"


@pytest.mark.parametrize(
    "options",
    [
        {"resolution": 0}, {"resolution": float("nan")}, {"headroom": -1}, {"slope": 90}, {"climb": float("inf")},
        {"up": "x"}, {"level": -1}, {"seed_point": (1,)}, {"seed_point": (float("nan"), 0)}, {"unknown": "maybe"},
        {"colour": "red"}, {"lanes": "fly"},
    ],
)  # fmt: skip
def test_options_are_checked(scene, options) -> None:
    with pytest.raises(ArgumentError, match=next(iter(options))):
        import_map(scene, "x.yaml", **options)
    assert names() == ["flat.navmesh"]


def test_a_missing_library_is_named(monkeypatch) -> None:
    find_spec = importlib.util.find_spec
    hidden = ("trimesh", "pxr")
    monkeypatch.setattr("irsim.common.extras.find_spec", lambda name: None if name in hidden else find_spec(name))
    with pytest.raises(ExtraError, match=r"irsim-mcp\[mesh\]"):
        import_map(write_glb(Path("a.glb"), box([0, 0, 0], [1, 1, 1])), "x.yaml")
    Path("a.usda").write_text("#usda 1.0\n")
    with pytest.raises(ExtraError, match=r"irsim-mcp\[usd\]"):
        import_map("a.usda", "x.yaml")


def test_archives_that_would_grow_are_refused(monkeypatch) -> None:
    monkeypatch.setattr("irsim.common.extras.find_spec", lambda name: True)
    file = Path("bomb.usdz")
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.usda", b"0" * 10_000_000)
    with pytest.raises(BridgeError, match="compressed"):
        import_map(file, "x.yaml")
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("../a.usda", b"#usda 1.0")
    with pytest.raises(BridgeError, match="outside of it"):
        import_map(file, "x.yaml")
    file.write_bytes(b"PK\x03\x04" + bytes(100))
    with pytest.raises(BridgeError, match="not an archive"):
        import_map(file, "x.yaml")


def test_the_command_lists_the_parts_that_are_not_free() -> None:
    Path("rooms.navmesh").write_bytes(mesh_set(tile(((0, 0, 3, 3, 0), (4, 0, 6, 3, 0)))))
    assert "free: 9.0 m²; other parts of this level [m²]: 6.0\n" in call("rooms.navmesh", "-o", "a.yaml").output
    small = call("rooms.navmesh", "-o", "b.yaml", "--seed-point", "5,1")
    assert "free: 6.0 m²; other parts of this level [m²]: 9.0\n" in small.output


def call(*words: str):
    return CliRunner().invoke(app, ["map", "import", *words])


def test_the_command(scene) -> None:
    listed = call("flat.navmesh", "--list-levels")
    assert listed.exit_code == 0
    assert "level 1: floor at 3.00 m, 9.0 m² connected" in listed.output
    done = call("flat.navmesh", "-o", "up.yaml", "--height", "2.8", "--add-robot")
    assert done.exit_code == 0
    wrote = "wrote up.yaml, up.png, up.bridge.json"
    for said in (wrote, "floor at 3.00 m, 9.0 m² connected", "this one", "irsim run up.yaml"):
        assert said in done.output, said
    answer = json.loads(call("flat.navmesh", "-o", "b.yaml", "--seed-point", "1,1", "--json").output)
    assert answer["files"] == ["b.yaml", "b.png", "b.bridge.json"]
    assert answer["trip"]["start"][2] == answer["trip"]["goal"][2]
    for words, said in [
        (("flat.navmesh",), "add -o"),
        (("flat.navmesh", "-o", "c.yaml", "--level", "7"), "no level 7"),
        (("flat.navmesh", "-o", "c.yaml", "--seed-point", "1;1"), "--seed-point 1.5,2"),
        (("flat.navmesh", "-o", "c.yaml", "--resolution", "-1"), "resolution"),
        (("flat.navmesh", "-o", "b.yaml"), "exists"),
        (("none.glb", "-o", "c.yaml"), "cannot be read"),
    ]:
        wrong = call(*words)
        assert wrong.exit_code == 2, wrong.output
        assert said in wrong.output
    assert not Path("c.yaml").exists()
    assert call("flat.navmesh", "-o", "none/b.yaml").exit_code == 0
    assert Path("none/b.bridge.json").exists(), "the folder is made"
    lost = call("flat.navmesh", "-o", "b.yaml/c.yaml")
    assert (lost.exit_code, "'b.yaml' is not a folder" in lost.output) == (1, True)


def test_the_map_is_where_the_scene_is(scene) -> None:
    import_map(scene, "a.yaml", resolution=0.1)
    grid = read(Path("a.yaml")).scenario.grid
    free = np.argwhere(grid.cells.occupied == 0)
    corners = np.array(grid.origin) + np.array([free.min(axis=0), free.max(axis=0) + 1]) * 0.1
    np.testing.assert_allclose(corners, [[0, 0], [7, 3]], atol=0.06)


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


def test_options_that_say_nothing_about_a_file_are_refused(scene) -> None:
    Path("road.xodr").write_text("<OpenDRIVE/>")
    for name, file in (("headroom", scene), ("up", scene), ("opacity", scene), ("slope", "road.xodr")):
        with pytest.raises(ArgumentError, match=f"the option {name} says nothing about .* Fix: leave out --{name}"):
            import_map(file, "a.yaml", **{name: "y" if name == "up" else 0.3})
    import_map(scene, "a.yaml", ros_map="map.yaml")
    with pytest.raises(ArgumentError, match="the option resolution says nothing about the YAML file"):
        import_map("map.yaml", "b.yaml", resolution=0.1)


def test_a_root_that_is_not_there_is_named() -> None:
    Path("world.sdf").write_text('<sdf version="1.9"><world name="w"/></sdf>')
    with pytest.raises(ArgumentError, match=r"there is no folder 'modles'\. Fix: give with --root"):
        import_map("world.sdf", "a.yaml", root="modles")


def test_what_a_map_is_made_from_is_not_overwritten(scene) -> None:
    import_map(scene, "a.yaml", ros_map="map.yaml")
    Path("map.pgm").rename("picture.png")
    text = Path("map.yaml").read_text().replace("map.pgm", "picture.png")
    Path("map.yaml").write_text(text)
    for name in ("map.yaml", "picture.yaml"):
        with pytest.raises(TargetError, match="is what the map is made from"):
            import_map("map.yaml", name, overwrite=True)
    assert Path("map.yaml").read_text() == text
    assert not Path("picture.yaml").exists()


def test_a_map_without_room(scene) -> None:
    with pytest.raises(BridgeError, match="no room for a robot"):
        import_map(scene, "a.yaml", robot=True, radius=8)
    assert "no cell is free" in import_map(scene, "a.yaml", radius=8).notes


def test_a_picture_that_is_missing_is_a_key_of_the_map() -> None:
    Path("map.yaml").write_text("image: nope.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n")
    with pytest.raises(BridgeError, match=r"nope\.pgm' in .*\. Fix: correct the key image"):
        import_map("map.yaml", "a.yaml")


def test_roads_that_declare_entities_are_refused_in_one_sentence() -> None:
    road = Path("road.xodr")
    road.write_text('<!DOCTYPE r [<!ENTITY a "b">]><OpenDRIVE/>')
    with pytest.raises(BridgeError) as caught:
        import_map(road, "a.yaml")
    assert str(caught.value).count("cannot be imported") == 1


def test_what_is_unknown_stays_unknown(scene) -> None:
    import_map(scene, "a.yaml", ros_map="map.yaml")
    for name, result in (
        ("ros", import_map("map.yaml", "ros.yaml", robot=True)),
        ("mesh", import_map(scene, "mesh.yaml", unknown="unknown", robot=True)),
    ):
        assert f"{name}.map.yaml" in {Path(file).name for file in result.files}
        assert result.unknown_as == read_sidecar(f"{name}.yaml").unknown == "unknown"
        grid = read(Path(f"{name}.yaml")).scenario.grid
        assert result.unknown == grid.cells.unknown.sum() > 0
        assert result.occupied == grid.cells.count
        assert api.validate(f"{name}.yaml", strict=True).valid
        assert api.run(f"{name}.yaml", seed=1).outcome == "success"
    import_map("ros.map.yaml", "again.yaml")
    assert (read(Path("again.yaml")).scenario.grid.cells.unknown == grid.cells.unknown).all()


def test_a_map_that_is_known_stays_a_picture(scene) -> None:
    import_map(scene, "a.yaml", ros_map="map.yaml", unknown="occupied")
    Image.fromarray(np.full((20, 20), 254, np.uint8)).save("map.pgm")
    result = import_map("map.yaml", "known.yaml")
    assert (result.unknown, [Path(file).suffix for file in result.files]) == (0, [".yaml", ".png", ".json"])
