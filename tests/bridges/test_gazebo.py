"""Recorded runs as worlds of Gazebo and models of MuJoCo, written without either."""

from __future__ import annotations

import re
import shlex
import shutil
import time
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
import shapely
from typer.testing import CliRunner

import irsim
from irsim.bridges.sdf import SdfWorld, prism
from irsim.cli.app import app
from irsim.runs import Run, RunError, open_run
from irsim.simulation.scene import Grid
from tests.bridges.scenes import gallery

TRAFFIC = """\
world: {width: 12, height: 8, collision_mode: unobstructed, boundary: walls}
robot:
  - name: rover
    kinematics: {name: diff}
    state: [1, 1, 0]
    goal: [5, 1, 0]
    behavior: {name: dash}
    sensors: [{name: lidar2d, number: 5, range_max: 3}]
obstacle:
  - {name: walker, kinematics: {name: omni}, state: [6, 6, 0], goal: [9, 2, 0], behavior: {name: dash}}
  - {name: waiting, kinematics: {name: omni}, state: [2, 6, 0]}
  - {name: crate, shape: {name: polygon, vertices: [[0, 0], [2, 0], [2, 2], [1, 0.5], [0, 2]]}, state: [4, 5, 0]}
"""


@pytest.fixture
def traffic(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    monkeypatch.chdir(tmp_path)
    return open_run(str(irsim.run(text=TRAFFIC, seed=3, steps=25, record=True).run_id))


def test_a_run_becomes_a_world_with_actors_on_the_recorded_paths(traffic: Run) -> None:
    done = CliRunner().invoke(app, ["export", "--to", "sdf", "-o", "town"])
    assert done.exit_code == 0, done.output
    assert "cmd_vel" in done.output
    world = ET.parse("town/world.sdf").getroot().find("world")
    assert world is not None
    assert [actor.get("name") for actor in world.findall("actor")] == ["walker"]
    waypoints = world.findall("actor/script/trajectory/waypoint")
    where = np.array([(point.findtext("pose") or "").split() for point in waypoints], dtype=float)
    trace = traffic.trace()
    np.testing.assert_allclose(where[:, [0, 1, 5]], trace.pose[:, traffic.index_of("walker")], atol=1e-9)
    np.testing.assert_allclose([float(point.findtext("time") or "nan") for point in waypoints], trace.time)
    names = [model.get("name") for model in world.findall("model")]
    assert sorted(str(name) for name in names) == ["boundary", "crate", "ground", "rover", "waiting"]
    rover = world.find("model[@name='rover']")
    assert rover is not None
    assert rover.findtext("static") == "false"
    assert rover.findtext("link/sensor/lidar/scan/horizontal/samples") == "5"


def test_every_mesh_of_a_world_is_a_file_and_every_file_is_a_closed_prism(traffic: Run) -> None:
    irsim.export_run(traffic, "town", to="sdf")
    named = {uri.text for uri in ET.parse("town/world.sdf").getroot().iter("uri")}
    files = {f"meshes/{path.name}" for path in Path("town/meshes").iterdir()}
    assert named == files
    area = 0.0
    for file in files:
        lines = [line.split() for line in Path("town", file).read_text().splitlines()]
        points = np.array([line[1:] for line in lines if line[0] == "v"], dtype=float)
        faces = np.array([line[1:] for line in lines if line[0] == "f"], dtype=int) - 1
        edges = [(int(face[k]), int(face[(k + 1) % 3])) for face in faces for k in range(3)]
        assert len(set(edges)) == len(edges)
        assert {(b, a) for a, b in edges} == set(edges)  # each edge has one face on either side
        a, b, c = (points[faces[:, k]] for k in range(3))
        area += float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)  # the volume, as the height is 1 m
    outline = [[0, 0], [2, 0], [2, 2], [1, 0.5], [0, 2]]
    assert area == pytest.approx(shapely.Polygon(outline).area)


def test_a_run_becomes_a_model_of_mujoco(traffic: Run) -> None:
    result = irsim.export_run(traffic, "scene.xml", to="mjcf")
    assert result.format == "mjcf"
    model = ET.parse("scene.xml").getroot()
    assert {body.get("name") for body in model.findall("worldbody/body")} >= {"rover", "walker", "waiting", "crate"}
    assert any("mocap" in note for note in result.notes)
    again = irsim.export_run(traffic, "again.xml", to="mjcf")
    assert Path(again.file).read_bytes() == Path("scene.xml").read_bytes()


def test_a_folder_that_exists_is_not_touched(traffic: Run) -> None:
    Path("town").mkdir()
    done = CliRunner().invoke(app, ["export", "--to", "sdf", "-o", "town"])
    assert done.exit_code == 2
    assert "exists" in done.output
    assert not any(Path("town").iterdir())
    shutil.rmtree("town")


def test_names_of_a_world_are_unique_and_legal() -> None:
    from dataclasses import replace

    scene = gallery()
    odd = ("a::b", "a b", "a/b", "__root__", "world", "ground", "???", "map", "ü")
    scene = replace(scene, agents=tuple(replace(one, name=n) for one, n in zip(scene.agents, odd, strict=True)))
    world = ET.fromstring(SdfWorld(scene, {}).write()).find("world")
    assert world is not None
    names = [str(model.get("name")) for model in world.findall("model")]
    assert len(set(names)) == len(names) == len(odd) + 3
    assert not [name for name in names if "::" in name or " " in name or name.startswith("__") or name == "world"]


def test_a_prism_stands_between_its_heights() -> None:
    text = prism(np.array([[0, 0], [1, 0], [0, 1]], dtype=float), 0.25, 1.5)
    heights = {line.split()[3] for line in text.splitlines() if line.startswith("v")}
    assert heights == {"0.25", "1.5"}
    assert text.count("\nf ") == 2 + 6


def test_what_the_page_says_works(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = Path(__file__).resolve().parents[2] / "skills/irsim-runner/bridges/gazebo.md"
    [block] = re.findall(r"```bash\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    monkeypatch.chdir(tmp_path)
    Path("hall.yaml").write_text(TRAFFIC, encoding="utf-8")
    for command in block.splitlines():
        done = CliRunner().invoke(app, shlex.split(command)[1:])
        assert done.exit_code == 0, (command, done.output)
    assert Path("hall-gazebo/world.sdf").stat().st_size > 5000


@pytest.mark.parametrize("to", ["mjcf", "sdf"])
def test_a_world_without_anything_that_moves_is_a_scene_as_well(
    to: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    crate = "obstacle: [{name: crate, shape: {name: circle, radius: 0.5}, state: [4, 4]}]"
    for text, models in (("", 0), (crate, 1)):
        run = irsim.run(text=f"world: {{width: 9, height: 9}}\n{text}", seed=1, steps=2, record=True)
        result = irsim.export_run(str(run.run_id), to=to, out=f"{to}{models}.{'xml' if to == 'mjcf' else 'd'}")
        file = Path(result.file)
        assert (file if file.is_file() else file / "world.sdf").read_text().count('name="crate"') == models
    with pytest.raises(RunError, match="has no objects"):
        irsim.export_run(str(irsim.run(text="world: {width: 9}", steps=1, record=True).run_id), to="csv", objects="all")


def test_maps_of_many_parts_become_a_world_in_seconds() -> None:
    board = np.indices((240, 240)).sum(axis=0) % 2 == 0
    scene = replace(gallery(), grid=Grid(board, (0.1, 0.1), (0.0, 0.0)))
    start = time.process_time()
    text = SdfWorld(scene, {}).write()
    assert time.process_time() - start < 15, "it is about 2 s; it grew with the square of the number of parts"
    names = re.findall(r'<collision name="(collision_\d+)"', text[text.index('<model name="map"') :])
    assert names[:28_800] == [f"collision_{number}" for number in range(28_800)]
