"""Maps of the ROS map server: what they mean, and that they come back as they went out."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image
from typer.testing import CliRunner

from irsim import api
from irsim.bridges.maps import import_map
from irsim.bridges.maps.ros_server import MapFileError, export_map
from irsim.cli.app import app
from irsim.common.files import TargetError
from irsim.components.maps._rosmap import MODES, RosMeta, occupancy_of, pixels_of
from irsim.scenario.limits import Limits
from irsim.scenario.read import read

GREYS = np.array([[0, 60, 100, 205, 230, 254, 255]], np.uint8)


def meta(**overrides) -> RosMeta:
    return RosMeta(**{"image": "map.pgm", "resolution": 0.1, **overrides})


def write(folder: Path, pixels: np.ndarray, **keys) -> Path:
    """A map of the map server."""
    Image.fromarray(pixels).save(folder / "map.pgm")
    file = folder / "map.yaml"
    values = {"image": "map.pgm", "resolution": 0.5, "origin": [-1.0, 2.0, 0.0], "negate": 0}
    file.write_text(yaml.safe_dump({**values, "occupied_thresh": 0.65, "free_thresh": 0.196, **keys}))
    return file


def world_of(folder: Path, keys: str = "", more: str = "") -> Path:
    """A scenario of the map beside it."""
    file = folder / "s.yaml"
    file.write_text(f"world: {{{keys}obstacle_map: {{name: ros, path: map.yaml{more}}}}}\n")
    return file


def corner() -> np.ndarray:
    """4 x 6 pixels: the top left one is occupied, the bottom right one unknown."""
    pixels = np.full((4, 6), 254, np.uint8)
    pixels[0, 0], pixels[3, 5] = 0, 205
    return pixels


def test_pixels_mean_what_the_map_server_says() -> None:
    assert occupancy_of(GREYS, meta()).tolist() == [[100, 100, -1, -1, 0, 0, 0]]
    assert occupancy_of(GREYS, meta(negate=True)).tolist() == [[0, -1, -1, 100, 100, 100, 100]]
    assert occupancy_of(GREYS, meta(mode="raw")).tolist() == [[0, 60, 100, -1, -1, -1, -1]]
    scaled = occupancy_of(GREYS, meta(mode="scale"))[0]
    part = 1 - 100 / 255
    assert scaled[2] == round(99 * (part - 0.196) / (0.65 - 0.196))
    assert scaled[[0, 4, 6]].tolist() == [100, 0, 0]
    opaque = np.stack([GREYS, np.where(GREYS == 100, 0, 255).astype(np.uint8)], axis=-1)
    assert occupancy_of(opaque, meta(mode="scale"))[0, 2] == -1
    colors = np.stack([GREYS, GREYS, GREYS], axis=-1)
    assert (occupancy_of(colors, meta()) == occupancy_of(GREYS, meta())).all()


@given(
    seed=st.integers(0, 1000),
    mode=st.sampled_from(MODES),
    negate=st.booleans(),
    thresholds=st.sampled_from([(0.65, 0.196), (0.9, 0.5), (0.6, 0.3)]),
)
def test_round_trip(seed, mode, negate, thresholds) -> None:
    rng = np.random.default_rng(seed)
    steps = {"trinary": [-1.0, 0.0, 100.0], "scale": [-1.0, 0.0, 20.0, 70.0, 100.0], "raw": [-1.0, 0.0, 33.0, 100.0]}
    values = rng.choice(steps[mode], (9, 5))
    how = meta(mode=mode, negate=negate and mode != "raw", occupied_thresh=thresholds[0], free_thresh=thresholds[1])
    back = occupancy_of(pixels_of(values, how), how).T[:, ::-1]
    if mode == "scale":
        assert back == pytest.approx(values, abs=2)
        assert ((back < 0) == (values < 0)).all()
    else:
        assert (back == values).all()


def test_the_world_takes_its_extent_from_the_map(tmp_path) -> None:
    write(tmp_path, corner())
    reading = read(world_of(tmp_path, more=", unknown: free"))
    world, grid = reading.scenario.world, reading.scenario.grid
    assert reading.diagnostics == []
    assert (world.width, world.height, world.offset) == (3.0, 2.0, [-1.0, 2.0])
    assert grid.cell == (0.5, 0.5)
    assert np.argwhere(grid.cells.occupied).tolist() == [[0, 3]]
    grid = read(world_of(tmp_path, more=", unknown: occupied")).scenario.grid
    assert np.argwhere(grid.cells.occupied).tolist() == [[0, 3], [5, 0]]


def test_a_given_extent_cuts_and_pads(tmp_path) -> None:
    write(tmp_path, corner())
    scenario = read(world_of(tmp_path, "width: 5, height: 3, offset: [-2, 2], ")).scenario
    assert scenario.world.bounds == (-2.0, 2.0, 3.0, 5.0)
    assert scenario.grid.size == (10, 6)
    [cell] = np.argwhere(scenario.grid.cells.occupied)
    assert cell.tolist() == [2, 3]  # the pixel keeps its place: x from -1 to -0.5, y from 3.5 to 4


@pytest.mark.parametrize("yaw", [math.pi / 2, 0.3, -2.0])
def test_turned_maps_are_sampled_anew(tmp_path, yaw) -> None:
    pixels = np.full((40, 60), 254, np.uint8)
    pixels[5:9, 10:50] = 0  # a bar, 4 m x 0.4 m
    write(tmp_path, pixels, resolution=0.1, origin=[1.0, 2.0, yaw])
    scenario = read(world_of(tmp_path)).scenario
    c, s = math.cos(yaw), math.sin(yaw)
    cells = scenario.grid.cells
    i, j = np.nonzero(cells.occupied)
    x, y = np.array(cells.origin)[:, None] + (np.stack([i, j]) + 0.5) * 0.1 - [[1.0], [2.0]]
    along, across = c * x + s * y, -s * x + c * y
    assert [along.min(), along.max(), across.min(), across.max()] == pytest.approx([1.0, 5.0, 3.1, 3.5], abs=0.13)
    assert 160 <= cells.count <= 280  # of 160 pixels: never a hole, at the rim up to a cell more


def test_import_and_export(tmp_path) -> None:
    source = write(tmp_path, corner())
    written = import_map(source, tmp_path / "world.yaml", unknown="occupied")
    names = ("world.yaml", "world.png", "world.bridge.json")
    assert written.files == [str(tmp_path / name) for name in names]
    report = api.validate(tmp_path / "world.yaml")
    assert report.valid
    scenario, _ = api.read_scenario(tmp_path / "world.yaml", strict=True)
    assert np.argwhere(scenario.grid.cells.occupied).tolist() == [[0, 3], [5, 0]]
    assert scenario.world.bounds == (-1.0, 2.0, 2.0, 4.0)
    for mode in MODES:
        for image in ("pgm", "png"):
            out = tmp_path / f"{mode}-{image}.yaml"
            export_map(scenario, out, mode=mode, image=image)
            assert yaml.safe_load(out.read_text())["origin"] == [-1.0, 2.0, 0.0]
            back = {"world": {"obstacle_map": {"name": "ros", "path": str(out)}}}
            again = read(back).scenario
            assert (again.grid.cells.occupied == scenario.grid.cells.occupied).all()
            assert again.world.bounds == scenario.world.bounds
    with pytest.raises(TargetError):
        export_map(scenario, tmp_path / "raw-png.yaml", image="pgm", overwrite=False)
    with pytest.raises(TargetError, match="exists"):
        import_map(source, tmp_path / "world.yaml")


def test_oblong_cells_become_square(tmp_path) -> None:
    scenario = read({"world": {"width": 4, "height": 2, "obstacle_map": np.array([[0, 0], [100, 0]])}}).scenario
    assert scenario.grid.cell == (2.0, 1.0)
    written = export_map(scenario, tmp_path / "m.yaml")
    assert (written.columns, written.rows, written.resolution) == (4, 2, 1.0)
    again = read({"world": {"obstacle_map": {"name": "ros", "path": str(tmp_path / "m.yaml")}}}).scenario
    assert again.grid.cells.occupied.tolist() == [[0, 0], [0, 0], [1, 0], [1, 0]]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"resolution": -1}, "resolution"),
        ({"resolution": "fine"}, "resolution"),
        ({"origin": [1]}, "origin"),
        ({"occupied_thresh": 0.1}, "free_thresh"),
        ({"mode": "binary"}, "trinary, scale, raw"),
        ({"image": 3}, "image"),
    ],
)
def test_wrong_files_are_refused(tmp_path, change, said) -> None:
    write(tmp_path, corner(), **change)
    [diagnostic] = read(world_of(tmp_path)).diagnostics
    assert (diagnostic.code, diagnostic.severity, diagnostic.line) == ("map-unreadable", "error", 1)
    assert said in diagnostic.message
    with pytest.raises(MapFileError, match=said):
        import_map(tmp_path / "map.yaml", tmp_path / "out.yaml")


def test_no_map_no_picture_no_escape(tmp_path) -> None:
    file = world_of(tmp_path)
    assert [item.code for item in read(file).diagnostics] == ["map-not-found"]
    write(tmp_path, corner(), image="other.pgm")
    assert [item.code for item in read(file).diagnostics] == ["map-not-found"]
    (tmp_path / "map.yaml").write_text("- a list\n")
    assert [item.code for item in read(file).diagnostics] == ["map-unreadable"]
    inside = tmp_path / "inside"
    inside.mkdir()
    write(tmp_path, corner())
    write(inside, corner(), image="../map.pgm")
    reading = read(world_of(inside), limits=Limits(root=str(inside)))
    assert reading.scenario is None or reading.scenario.grid is None
    assert [item.code for item in reading.diagnostics] == ["path-outside-workspace"]


def test_the_command(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    write(tmp_path, corner())

    def call(*words: str):
        return CliRunner().invoke(app, list(words))

    result = call("map", "import", "map.yaml", "-o", "world.yaml")
    assert result.exit_code == 0
    assert "6 x 4 cells of 0.5 m, 1 occupied" in result.output
    result = call("map", "export", "world.yaml", "-o", "back.yaml", "--mode", "scale", "--image", "png", "--json")
    assert json.loads(result.output)["files"] == ["back.yaml", "back.png"]
    result = call("map", "export", "world.yaml", "-o", "other.yaml", "--mode", "scale")
    assert (result.exit_code, "--image png" in " ".join(result.output.split())) == (2, True)
    assert call("map", "export", "world.yaml", "-o", "back.yaml").exit_code == 2
    assert call("map", "export", "world.yaml", "-o", "back.yaml", "--force").exit_code == 0
    assert call("map", "import", "none.yaml", "-o", "w.yaml").exit_code == 2
    Path("empty.yaml").write_text("world: {width: 5}\n")
    result = call("map", "export", "empty.yaml", "-o", "e.yaml")
    assert (result.exit_code, "no-map" in result.output) == (2, True)
