"""Meshes as others write them: all formats give one map, large ones in time, hostile ones are refused; the page."""

from __future__ import annotations

import re
import shlex
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

from irsim import api
from irsim.bridges.base import BridgeError
from irsim.bridges.frames import turn_of
from irsim.bridges.maps import import_map, read_sidecar
from irsim.cli.app import app
from irsim.common.held import Folder
from irsim.diagnostics.errors import ArgumentError
from irsim.scenario.read import read
from tests.bridges.maps.scenes import TWO_ROOMS, box, flat, house, mesh_set, storey, tile, write_glb, write_obj, y_up
from tests.bridges.maps.test_obstacles import WORLD

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("meshes")]
trimesh = pytest.importorskip("trimesh")
from irsim.bridges.maps.kinds._mesh_process import load  # noqa: E402


def soup(triangles: np.ndarray):
    return trimesh.Trimesh(triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3), process=False)


def cells(folder: Path, name: str) -> np.ndarray:
    return read(folder / f"{name}.yaml").scenario.grid.cells.occupied


def test_a_flat_from_a_file_to_a_run(tmp_path) -> None:
    """The three commands of the documentation, as functions."""
    result = import_map(write_glb(tmp_path / "flat.glb", flat()), tmp_path / "flat.yaml", robot=True)
    assert result.free_area == pytest.approx(40.5, abs=0.5)
    assert api.validate(tmp_path / "flat.yaml").valid
    run = api.run(tmp_path / "flat.yaml", seed=0)
    assert run.outcome == "success"
    sidecar = read_sidecar(tmp_path / "flat.yaml")
    assert sidecar.frame == "habitat_yup"
    there = sidecar.to_scene([[1.8, 1.45]], height=0.75)  # the middle of the table top
    assert there == pytest.approx(np.array([[1.8, 0.75, -1.45]]), abs=0.01)


def test_a_large_mesh_gets_cells_that_fit(tmp_path) -> None:
    ground = write_obj(tmp_path / "a.obj", y_up(box([0, 0, 0], [150, 150, 0.1])))
    result = import_map(ground, tmp_path / "a.yaml")
    assert (result.resolution, result.free_area) == (0.1, pytest.approx(150**2, rel=0.01))
    assert any("cells are 0.1 m" in note for note in result.notes)
    with pytest.raises(BridgeError, match=r"--resolution 0\.1\b"):
        import_map(ground, tmp_path / "b.yaml", resolution=0.05)


def test_a_mesh_is_turned_by_hand(tmp_path) -> None:
    turn = turn_of(*np.radians([65, -20, 10]))
    straight = import_map(write_obj(tmp_path / "a.obj", flat()), tmp_path / "a.yaml", up="z")
    tilted = write_obj(tmp_path / "b.obj", flat() @ turn)
    result = import_map(tilted, tmp_path / "b.yaml", up="z", rotate=(65, -20, 10))
    assert result.free_area == pytest.approx(straight.free_area, rel=0.04)  # walls lie on borders of cells
    sidecar = read_sidecar(tmp_path / "b.yaml")
    here = np.array([[1.8, 1.45, 0.75]])
    np.testing.assert_allclose(
        sidecar.to_irsim(here @ turn), read_sidecar(tmp_path / "a.yaml").to_irsim(here), atol=0.01
    )


@pytest.mark.parametrize("suffix", ["glb", "gltf", "obj", "ply", "stl"])
def test_every_format_gives_the_same_map(tmp_path, suffix) -> None:
    up = "y" if suffix in ("glb", "gltf", "obj") else "z"
    mesh = soup(y_up(flat()) if up == "y" else flat())
    file = tmp_path / f"flat.{suffix}"
    if suffix == "gltf":
        for name, content in trimesh.exchange.gltf.export_gltf(trimesh.Scene(mesh)).items():
            (tmp_path / ("flat.gltf" if name.endswith(".gltf") else name)).write_bytes(content)
    else:
        mesh.export(file)
    import_map(file, tmp_path / "a.yaml")
    import_map(write_obj(tmp_path / "plain.obj", y_up(flat())), tmp_path / "b.yaml")
    a, b = cells(tmp_path, "a"), cells(tmp_path, "b")
    assert a.shape == b.shape
    assert (a != b).mean() < 0.01


def test_a_gltf_reads_files_below_the_root(tmp_path) -> None:
    (tmp_path / "scenes").mkdir()
    file = tmp_path / "scenes/flat.gltf"
    for name, content in trimesh.exchange.gltf.export_gltf(trimesh.Scene(soup(y_up(flat())))).items():
        target = file if name.endswith(".gltf") else tmp_path / name
        target.write_bytes(content.replace(b'"uri":"', b'"uri":"../'))
    with pytest.raises(BridgeError, match="leads upwards"):
        import_map(file, tmp_path / "a.yaml")
    assert import_map(file, tmp_path / "a.yaml", root=str(tmp_path)).free_area == pytest.approx(40.5, abs=0.5)


def test_nodes_move_and_mirror_their_meshes(tmp_path) -> None:
    scene = trimesh.Scene()
    turned = np.diag([1.0, 1.0, -1.0, 1.0])
    turned[:3, 3] = [3.0, 0.5, 0.0]
    scene.add_geometry(soup(y_up(flat())), transform=turned)
    scene.export(tmp_path / "moved.glb")
    result = import_map(tmp_path / "moved.glb", tmp_path / "moved.yaml")
    assert result.free_area == pytest.approx(40.5, abs=0.5)
    assert result.height == pytest.approx(0.5, abs=0.01)
    assert result.origin[0] > 2.5
    assert result.origin[1] < -5


def test_a_scan_with_its_winding_reversed_and_one_with_another_up(tmp_path) -> None:
    inside_out = write_glb(tmp_path / "a.glb", flat()[:, ::-1])
    ceiling = import_map(inside_out, tmp_path / "a.yaml")
    assert ceiling.levels
    sheet = np.array([[[0, 0, 0], [9, 9, 0], [9, 0, 0]], [[0, 0, 0], [0, 9, 0], [9, 9, 0]]], float)
    down = import_map(write_glb(tmp_path / "b.glb", sheet), tmp_path / "b.yaml")
    assert down.free_area == pytest.approx(81, rel=0.02)
    assert any("face downward" in note for note in down.notes)
    lying = write_obj(tmp_path / "c.obj", flat())  # z up, and OBJ is taken as y up
    matches = import_map(lying, tmp_path / "c.yaml")
    assert any("along z, which is taken to point up" in note for note in matches.notes)
    assert matches.free_area == pytest.approx(40.5, abs=0.5)
    assert import_map(lying, tmp_path / "d.yaml", up="z").free_area == matches.free_area


def test_three_million_triangles_in_seconds(tmp_path) -> None:
    """A noisy floor of 30 m x 20 m. The limit is for a loaded machine; alone it takes about 6 s of processor time."""
    n = 1250
    rng = np.random.default_rng(0)
    x, y = np.meshgrid(np.linspace(0, 30, n), np.linspace(0, 20, n), indexing="ij")
    points = np.stack([x, rng.normal(0, 0.01, x.shape), -y], -1)
    k = np.arange(n * n).reshape(n, n)
    quads = [k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]]
    faces = np.concatenate([np.stack([quads[a].ravel() for a in abc], 1) for abc in ((0, 1, 2), (0, 2, 3))])
    trimesh.Trimesh(points.reshape(-1, 3), faces, process=False).export(tmp_path / "scan.glb")
    begin = time.process_time()
    result = import_map(tmp_path / "scan.glb", tmp_path / "scan.yaml")
    assert time.process_time() - begin < 20
    assert len(faces) > 3_100_000
    assert result.free_area == pytest.approx(600, rel=0.02)


@pytest.mark.parametrize("suffix", ["glb", "obj", "ply", "stl"])
def test_files_that_end_anywhere_give_a_map_or_an_error(tmp_path, suffix) -> None:
    mesh = soup(y_up(box([0, 0, 0], [2, 2, 1])) if suffix in ("glb", "obj") else box([0, 0, 0], [2, 2, 1]))
    mesh.export(tmp_path / f"whole.{suffix}")
    content = (tmp_path / f"whole.{suffix}").read_bytes()
    for length in range(0, len(content), 97):
        (tmp_path / f"cut.{suffix}").write_bytes(content[:length])
        try:
            import_map(tmp_path / f"cut.{suffix}", tmp_path / "cut.yaml")
        except BridgeError:
            assert not (tmp_path / "cut.yaml").exists()
        else:
            assert suffix == "obj"  # each line of which stands for itself
            for name in ("cut.yaml", "cut.png", "cut.bridge.json"):
                (tmp_path / name).unlink()


@pytest.mark.parametrize("suffix", ["glb", "obj", "ply", "stl"])
@given(data=st.data())
@settings(max_examples=5, deadline=None)
def test_changed_bytes_give_a_map_or_an_error(tmp_path_factory, suffix, data) -> None:
    """A process reads each file, so that examples are few."""
    folder = tmp_path_factory.mktemp("changed")
    soup(box([0, 0, 0], [2, 2, 1])).export(folder / f"box.{suffix}")
    content = bytearray((folder / f"box.{suffix}").read_bytes())
    for _ in range(data.draw(st.integers(1, 5))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    (folder / f"box.{suffix}").write_bytes(content)
    with suppress(BridgeError):
        import_map(folder / f"box.{suffix}", folder / "box.yaml", resolution=0.2)
    assert len(list(folder.iterdir())) in (1, 4)


def test_other_hostile_files(tmp_path) -> None:
    triangles = box([0, 0, 0], [2, 2, 1])
    nan = triangles.copy()
    nan[0, 0, 0] = np.nan
    soup(nan).export(tmp_path / "nan.stl")
    soup(box([0, 0, 0], [8e7, 8e7, 1])).export(tmp_path / "land.stl")
    (tmp_path / "faces.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")
    (tmp_path / "points.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\n")
    (tmp_path / "big.obj").write_text("v 0 0 0\nv 1e39 0 0\nv 0 1e39 1e39\nf 1 2 3\n")
    trimesh.PointCloud(np.random.default_rng(0).random((9, 3))).export(tmp_path / "cloud.ply")
    for name, said in [
        ("nan.stl", "not numbers"),
        ("land.stl", "more than 8,000,000 cells of 100 m"),
        ("faces.obj", "vertex|damaged"),
        ("points.obj", "no triangles|damaged"),
        ("big.obj", "--bounds|not numbers"),
        ("cloud.ply", "no faces"),
    ]:
        with pytest.raises(BridgeError, match=said):
            import_map(tmp_path / name, tmp_path / "x.yaml")
    assert not (tmp_path / "x.yaml").exists()


def test_textures_are_not_needed(tmp_path) -> None:
    """As in scans of HM3D: pictures in a format that needs an extension."""

    def change(content) -> None:
        content["extensionsUsed"] = content["extensionsRequired"] = ["KHR_texture_basisu"]
        content["images"] = [{"mimeType": "image/ktx2", "bufferView": 0}, {"uri": "http://127.0.0.1:9/x.ktx2"}]
        content["textures"] = [{"extensions": {"KHR_texture_basisu": {"source": 0}}}]
        content["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]
        content["meshes"][0]["primitives"][0]["material"] = 0

    result = import_map(write_glb(tmp_path / "hm3d.glb", flat(), change=change), tmp_path / "a.yaml")
    assert result.free_area == pytest.approx(40.5, abs=0.5)


def test_an_obj_names_materials_and_nothing_is_opened(tmp_path, monkeypatch) -> None:
    text = write_obj(tmp_path / "a.obj", y_up(flat())).read_text()
    (tmp_path / "secret.mtl").write_text("newmtl x\nmap_Kd http://127.0.0.1:9/x.png\n")
    (tmp_path / "a.obj").write_text("mtllib secret.mtl\nusemtl x\n" + text)
    opened = []
    real = Path.open
    monkeypatch.setattr(Path, "open", lambda self, *rest, **more: opened.append(self.name) or real(self, *rest, **more))
    load(tmp_path / "a.obj", {"bytes": 10**6, "triangles": 10**6})
    assert "secret.mtl" not in opened


def test_a_file_of_collada_says_its_unit_and_its_axis(tmp_path) -> None:
    pytest.importorskip("collada")
    scene = np.concatenate([box([0, 0, -0.1], [4, 3, 0]), box([1, 1, 0], [2, 2, 1])])
    for name, triangles, unit, axis in [("z", scene, 1, "Z_UP"), ("y", y_up(scene) * 100, 0.01, "Y_UP")]:
        corners = triangles.reshape(-1, 3)
        mesh = trimesh.Trimesh(corners, np.arange(len(corners)).reshape(-1, 3), process=False)
        text = trimesh.exchange.dae.export_collada(mesh).decode()
        text = re.sub(r"<unit[^>]*>", "", re.sub(r"<up_axis>.*?</up_axis>", "", text))
        text = re.sub("<asset>", f'<asset><unit meter="{unit}"/><up_axis>{axis}</up_axis>', text)
        (tmp_path / f"{name}.dae").write_text(text)
        result = import_map(tmp_path / f"{name}.dae", tmp_path / f"{name}.yaml")
        assert result.free_area == pytest.approx(11, abs=0.3)
        assert result.origin == pytest.approx((-0.05, -0.05), abs=0.11)
    (tmp_path / "x.dae").write_text(text.replace("<COLLADA", "<!DOCTYPE x SYSTEM 'x.dtd'><COLLADA"))
    with pytest.raises(BridgeError, match="type of document"):
        import_map(tmp_path / "x.dae", tmp_path / "x.yaml")


def floor_and_far(tmp_path: Path) -> Path:
    """A floor of 4 m x 3 m with a crate, and a crumb half a kilometer away, whose floor is in front of it."""
    crate = box([1, 1, 0], [2, 2, 1])
    far = box([500, 500, 0], [500.2, 500.2, 0.1])
    return write_obj(tmp_path / "scene.obj", y_up(np.concatenate([box([0, 0, -0.1], [4, 3, 0]), crate, far])))


def test_a_part_of_a_scene_is_imported_within_bounds(tmp_path) -> None:
    file = floor_and_far(tmp_path)
    with pytest.raises(BridgeError, match=r"--resolution .*, a part of it with --bounds, or its unit .*--meters-per-"):
        import_map(file, tmp_path / "a.yaml", resolution=0.05)
    result = import_map(file, tmp_path / "a.yaml", bounds=(-1, 0.5, 3, 3))
    assert result.free_area == pytest.approx(3 * 2.5 - 1, abs=0.4)
    assert result.origin[1] == pytest.approx(0.45, abs=0.051)
    with pytest.raises(BridgeError, match="nothing within the bounds"):
        import_map(file, tmp_path / "b.yaml", bounds=(10, 10, 20, 20))
    with pytest.raises(ArgumentError, match="the bounds 3, 3, 0, 0 hold nothing"):
        import_map(file, tmp_path / "b.yaml", bounds=(3, 3, 0, 0))
    assert not (tmp_path / "b.yaml").exists()


def test_a_mesh_in_millimeters(tmp_path) -> None:
    triangles = np.concatenate([box([0, 0, -0.1], [4, 3, 0]), box([1, 1, 0], [2, 2, 1])])
    write_obj(tmp_path / "m.obj", y_up(triangles))
    write_obj(tmp_path / "mm.obj", y_up(triangles * 1000))
    meters = import_map(tmp_path / "m.obj", tmp_path / "m.yaml")
    millimeters = import_map(tmp_path / "mm.obj", tmp_path / "mm.yaml", meters_per_unit=0.001)
    assert millimeters.free_area == pytest.approx(meters.free_area, abs=0.3)
    assert (millimeters.columns, millimeters.origin) == (meters.columns, meters.origin)
    points = read_sidecar(tmp_path / "mm.yaml").to_scene(np.array([[2.0, 1.0, 0.0]]), height=0.5)
    np.testing.assert_allclose(points, [[2000.0, 500.0, -1000.0]], atol=1e-6)


PAGE = Path(__file__).resolve().parents[2] / "skills" / "irsim-runner" / "bridges" / "maps.md"


def test_the_commands_and_the_program_of_the_page(tmp_path) -> None:
    write_glb(tmp_path / "flat.glb", flat())
    write_glb(tmp_path / "house.glb", house())
    z_up = storey()
    lying = np.stack([z_up[..., 0], -z_up[..., 2], z_up[..., 1]], axis=-1)
    write_glb(tmp_path / "scene.glb", lying)  # which the writer turns back: z is up in the file
    assert np.ptp(y_up(lying)[..., 2]) < 3.5
    (tmp_path / "scene.navmesh").write_bytes(mesh_set(tile(TWO_ROOMS), version=2))
    (tmp_path / "house.sdf").write_text(WORLD, encoding="utf-8")
    text = PAGE.read_text(encoding="utf-8")
    commands, [program] = (re.findall(rf"```{kind}\n(.*?)```", text, re.DOTALL) for kind in ("bash", "python"))
    for line in "\n".join(commands).splitlines():
        words = shlex.split(line, comments=True)
        if words[:1] == ["irsim"]:
            done = CliRunner().invoke(app, words[1:])
            assert done.exit_code == 0, (line, done.output)
    assert (tmp_path / "bed.yaml").is_file()
    seen: dict[str, np.ndarray] = {}
    exec(program, seen)
    assert seen["points"] == pytest.approx(np.array([[1, 1.2, -2], [1.5, 1.2, -2]]), abs=0.01)
    assert seen["back"] == pytest.approx(np.array([[1, 2, 1.2], [1.5, 2, 1.2]]), abs=1e-6)
    assert seen["matrices"].shape == (2, 4, 4)


def test_a_held_folder_is_held_by_the_reader_too(tmp_path, monkeypatch) -> None:
    write_glb(tmp_path / "flat.glb", flat())
    (tmp_path / "outside.glb").symlink_to("/etc/hostname")
    monkeypatch.setattr("irsim.common.held.PROCESS", [Folder(tmp_path)])
    assert import_map(tmp_path / "flat.glb", tmp_path / "flat.yaml").occupied > 0
    with pytest.raises(BridgeError, match="cannot be imported"):
        import_map(tmp_path / "outside.glb", tmp_path / "outside.yaml")
