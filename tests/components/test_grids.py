"""Pictures, noise, arrays and generators of user code become the grid that IR-SIM 2.12 makes of them."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from PIL import Image

import irsim
from irsim.components.maps._site import bundled_map, bundled_names
from irsim.diagnostics.errors import ScenarioError
from irsim.objects.drawing.scene_builder import SceneBuilder
from irsim.scenario.limits import Limits
from irsim.scenario.read import read
from irsim.world.map import (
    GridMapGenerator,
    ImageGridGenerator,
    ObstacleMap,
    PerlinGridGenerator,
    build_grid_from_generator,
    resolve_obstacle_map,
)

HERE = Path(__file__).parent
RECORDED = dict(np.load(HERE / "recorded" / "grids.npz"))
RECORD = runpy.run_path(str(HERE / "record.py"))
TRANSPARENT = ("rgba.png", "opacity.png")  # which IR-SIM 2.12 reads without their opacity (D24)
PICTURES = [name for name in RECORDED if not name.startswith("noise") and name not in TRANSPARENT]


def scenario(tmp_path: Path, obstacle_map: Any, **world: Any) -> Path:
    """A file with a robot in a world of 6 m x 3 m."""
    text = ", ".join(f"{key}: {value}" for key, value in {"width": 6, "height": 3, **world}.items())
    file = tmp_path / "map.yaml"
    file.write_text(
        f"world: {{{text}, obstacle_map: {obstacle_map}}}\n"
        "robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.1}, behavior: {name: dash}, goal: [5, 1],\n"
        "        state: [1, 1, 0]}\n"
    )
    return file


def make(tmp_path: Path, obstacle_map: Any, **world: Any) -> irsim.Env:
    return irsim.make(scenario(tmp_path, obstacle_map, **world), headless=True, log_level="ERROR")


@pytest.mark.parametrize("name", PICTURES)
def test_pictures_are_read_as_by_the_reference(name, tmp_path) -> None:
    env = make(tmp_path, HERE / "recorded" / name)
    assert env._world.grid_map == pytest.approx(RECORDED[name], abs=1e-9)
    full = RECORDED[name] > 50
    assert (env.simulation.state.cells(1).occupied == full).all()
    assert (ImageGridGenerator(str(HERE / "recorded" / name)).grid > 50).tolist() == full.tolist()


@pytest.mark.parametrize("number", range(len(RECORD["NOISE"])))
@pytest.mark.parametrize("size", RECORD["SIZES"])
def test_noise_is_that_of_the_reference(number, size) -> None:
    expected = RECORDED[f"noise_{number}_{size[0]}"]
    grid = PerlinGridGenerator(*size, **RECORD["NOISE"][number]).generate().grid
    assert (grid == 100.0 * expected).all()


def test_orientation(tmp_path) -> None:
    """A picture of an L: the long arm up along the left side, the foot to the right at the bottom."""
    pixels = np.full((3, 6), 255, np.uint8)
    pixels[:, 0] = pixels[2, 1] = 0
    Image.fromarray(pixels).save(tmp_path / "l.png")
    env = make(tmp_path, "l.png", offset="[-2, 10]")
    world = env._world
    assert world.reso.tolist() == [[1.0], [1.0]]
    assert world.obstacle_index.tolist() == [[0, 0, 0, 1], [0, 1, 2, 0]]
    assert world.obstacle_positions.T.tolist() == [[-1.5, 10.5], [-1.5, 11.5], [-1.5, 12.5], [-0.5, 10.5]]
    wall = env.obstacle_list[-1]
    assert isinstance(wall, ObstacleMap)
    assert (wall.name, wall.shape, wall.static, wall.kinematics, wall.goal) == ("obstacle_1", "map", True, None, None)
    assert (wall.geometry.bounds, wall.world_offset) == ((-2.0, 10.0, 0.0, 13.0), [-2.0, 10.0])
    assert ([line.length for line in wall.linestrings], wall.grid_map.shape) == ([10.0], (6, 3))
    assert wall.check_grid_collision(shapely.Point(-1, 12))  # touches
    assert not wall.is_collision(shapely.Point(-0.9, 12))
    assert not wall.is_collision(shapely.Point(40, 12))


def test_downsampling_keeps_the_most_occupied_cell_of_each_block(tmp_path) -> None:
    env = make(tmp_path, HERE / "recorded" / "grey.png", mdownsample=3)
    cells = RECORDED["grey.png"]
    blocks = [[cells[i : i + 3, j : j + 3].max() for j in range(0, cells.shape[1], 3)] for i in range(0, len(cells), 3)]
    assert env._world.grid_map == pytest.approx(np.array(blocks), abs=1e-9)
    assert env._world.reso[:, 0].tolist() == [6 / 4, 3 / 3]


def test_the_map_comes_after_the_obstacles_and_joins_no_group(tmp_path) -> None:
    file = scenario(tmp_path, HERE / "recorded" / "grey.png", boundary="walls")
    file.write_text(file.read_text() + "obstacle: {shape: {name: circle}, state: [3, 1]}\n")
    env = irsim.make(file, headless=True, log_level="ERROR")
    assert env.names == ["robot_0", "obstacle_1", "obstacle_2", "boundary"]
    assert [o.group for o in env.objects] == [0, 0, -1, -1]
    env.step()
    env.reset()
    assert [info.vertex is None for info in env.get_obstacle_info_list()] == [False, True, False]


def test_noise_without_a_seed_follows_the_scenario(tmp_path) -> None:
    file = scenario(tmp_path, "{name: perlin, resolution: 0.1}")
    maps = {}
    for seed in (1, 2):
        env = irsim.make(file, headless=True, seed=seed, log_level="ERROR")
        maps[seed] = env._world.grid_map
        env.reset()
        assert (env._world.grid_map == maps[seed]).all()
    assert (maps[1] != maps[2]).any()
    batch = irsim.batch(file, 2, seeds=[2, 1], threads=2)
    assert (batch.simulation.state.cells(3).occupied * 100 == maps[1]).all()
    batch.reset([True, True])
    env.reset(random=True)
    assert (batch.simulation.state.cells(1).occupied * 100 == env._world.grid_map).all()
    assert (env._world.grid_map != maps[2]).any()


def test_without_occupied_cells_there_is_no_object(tmp_path) -> None:
    Image.new("L", (4, 4), 255).save(tmp_path / "white.png")
    env = make(tmp_path, "white.png")
    assert env.names == ["robot_0"]
    assert env._world.grid_map.shape == (4, 4)
    assert env._world.obstacle_index.shape == (2, 0)


def test_bundled_maps() -> None:
    assert bundled_names() == ["cave.png", "flat_1.png", "flat_2.png", "maze.png", "office.png"]
    for name in bundled_names():
        reading = read({"world": {"width": 50, "height": 50, "obstacle_map": name}})
        assert reading.diagnostics == []
        grid = reading.scenario.grid.cells
        assert 0.02 < grid.count / np.prod(grid.shape) < 0.4
    [note] = read({"world": {"obstacle_map": "hm3d_5.png"}}).diagnostics
    assert (note.code, note.severity) == ("map-stand-in", "hint")
    assert bundled_map("hm3d_2.png").name == "flat_2.png"
    assert bundled_map("../_data/cave.png") is None


def test_the_cave_is_free_where_scripts_put_robots() -> None:
    robot = {"kinematics": {"name": "diff"}, "shape": {"name": "circle", "radius": 1.5}, "behavior": {"name": "dash"}}
    for x, y in ((5, 5), (45, 45), (25, 25), (5, 45), (45, 5)):
        world = {"width": 50, "height": 50, "obstacle_map": "cave.png"}
        data = {"world": world, "robot": {**robot, "goal": [9, 9], "state": [x, y, 0]}}
        assert read(data).diagnostics == [], (x, y)


@pytest.fixture
def stripes() -> type[GridMapGenerator]:
    class Stripes(GridMapGenerator):
        """Walls along y."""

        name = "stripes"
        yaml_param_names = ("period",)

        def __init__(self, width: int, height: int, period: int = 2) -> None:
            super().__init__()
            self.shape, self.period = (width, height), period

        def _build_grid(self) -> np.ndarray:
            if self.period < 1:
                raise ArithmeticError("no period")
            grid = np.zeros(self.shape)
            grid[:: self.period] = 100
            return grid

    return Stripes


def test_generators_of_user_code(tmp_path, stripes) -> None:
    env = make(tmp_path, "{name: stripes, resolution: 0.5, period: 3}")
    assert env._world.grid_map.shape == (12, 6)
    assert np.flatnonzero(env._world.grid_map[:, 0]).tolist() == [0, 3, 6, 9]
    assert GridMapGenerator.registry["stripes"] is stripes
    spec = {"name": "stripes", "resolution": 1.0, "other": 5}
    assert build_grid_from_generator(spec, 6.4, 4.5).shape == (6, 4)
    assert stripes(4, 2).grid[0].tolist() == [100, 100]
    stripes(4, 2).save_as_image(tmp_path / "a.png")
    assert np.asarray(Image.open(tmp_path / "a.png"))[:, 0, 0].tolist() == [0, 255, 0, 255]


def test_generators_that_fail(tmp_path, stripes) -> None:
    with pytest.raises(ScenarioError, match="ArithmeticError: no period"):
        make(tmp_path, "{name: stripes, resolution: 0.5, period: 0}")
    diagnostics = read(scenario(tmp_path, "{name: stripes, resolution: 0.5, perod: 1}"), strict=True).diagnostics
    (error,) = [item for item in diagnostics if item.severity == "error"]
    assert (error.code, error.path[-1]) == ("unknown-key", "perod")
    with pytest.raises(ValueError, match="built-in"):
        type("Mine", (GridMapGenerator,), {"name": "ros", "__module__": "mine"})


def test_resolving_by_hand() -> None:
    assert resolve_obstacle_map(None) is None
    assert resolve_obstacle_map(np.arange(6).reshape(2, 3)).tolist() == [[0, 1, 2], [3, 4, 5]]
    assert resolve_obstacle_map({"name": "perlin", "resolution": 0.5, "seed": 1}, 10.2, 10.3).shape == (20, 21)
    maps = ({"name": "image"}, {"name": "perlin"}, {"name": "nope", "resolution": 1})
    refused = {TypeError: (3, {"resolution": 1}, ["a"]), ValueError: maps, FileNotFoundError: ("nope.png",)}
    for error, wrong in [(error, wrong) for error, values in refused.items() for wrong in values]:
        with pytest.raises(error, match=r"need|unknown" if error is ValueError else None):
            resolve_obstacle_map(wrong, 5, 5)
    with pytest.raises(ValueError, match="octaves"):
        PerlinGridGenerator(5, 5, fractal=0)


def codes(path: Path, **limits: Any) -> list[str]:
    diagnostics = read(path, limits=Limits(**limits)).diagnostics
    return [
        f"{item.severity} {item.code} {item.line}"
        for item in diagnostics
        if item.code not in ("initial-overlap", "map-read-as")
    ]


@pytest.mark.parametrize(
    ("obstacle_map", "limits", "finding"),
    [
        ("text.png", {}, "error map-unreadable 1"),
        ("black.png", {}, "warning map-full 1"),
        ("large.png", {"cells": 1000}, "error map-too-large 1"),
        ("{name: perlin, resolution: 0.01, seed: 1}", {"cells": 1000}, "error map-too-large 1"),
        ("large.png", {"map_bytes": 10}, "error map-too-large 1"),
    ],
)
def test_what_is_wrong_with_a_map_is_said(tmp_path, obstacle_map, limits, finding) -> None:
    (tmp_path / "text.png").write_text("no picture")
    Image.new("L", (4, 4), 0).save(tmp_path / "black.png")
    Image.new("L", (40, 40), 0).save(tmp_path / "large.png")
    assert codes(scenario(tmp_path, obstacle_map), **limits) == [finding]


def test_maps_that_are_not_there(tmp_path) -> None:
    (tmp_path / "large.png").write_text("")
    [missing] = read(scenario(tmp_path, "lage.png")).diagnostics
    assert (missing.code, missing.fix) == ("map-not-found", "path: large.png")
    assert "cave.png" in str(missing.allowed)
    [missing] = read(scenario(tmp_path, "{name: image, path: cav.png}")).diagnostics
    assert (missing.fix, missing.path) == ("path: cave.png", ("world", "obstacle_map", "path"))
    [missing] = read(scenario(tmp_path, "{name: image, path: maze.pgm}")).diagnostics
    assert missing.fix == "give the path of the file relative to the scenario", "not of the bundled maze.png"


def test_maps_stay_inside_the_workspace(tmp_path) -> None:
    inside, outside = tmp_path / "inside", tmp_path / "secret.png"
    inside.mkdir()
    Image.new("L", (4, 4), 0).save(outside)
    (inside / "link.png").symlink_to(outside)
    Image.new("L", (4, 4), 0).save(inside / "own.png")
    for name in ("../secret.png", str(outside), "link.png"):
        assert codes(scenario(inside, f"'{name}'"), root=str(inside)) == ["error path-outside-workspace 1"]
    assert codes(scenario(inside, "cave.png"), root=str(inside)) == []
    assert codes(scenario(inside, "own.png"), root=str(inside)) == ["warning map-full 1"]


@pytest.mark.slow
def test_a_large_map_takes_little(tmp_path) -> None:
    rng = np.random.default_rng(0)
    coarse = rng.random((400, 400)) < 0.3
    Image.fromarray(np.kron(~coarse, np.ones((10, 10))).astype(np.uint8) * 255).save(tmp_path / "large.png")
    env = make(tmp_path, "large.png", width=400, height=400)
    grid = env.simulation.state.cells(1)
    assert grid.shape == (4000, 4000)
    assert grid.count == coarse.sum() * 100
    env.step()


def test_maps_are_drawn(tmp_path) -> None:
    file = scenario(tmp_path, HERE / "recorded" / "bits.png", boundary="walls")
    env = irsim.make(file, display=False, log_level="ERROR")
    env.render()
    picture = np.asarray(Image.open(env.save_figure(tmp_path / "out.png")).convert("L"))
    assert (picture == 0).mean() > 0.2
    [grid] = SceneBuilder(env.simulation).build().as_dict()["grids"]
    assert sum(grid["runs"][1::2]) == env.simulation.state.cells(1).count
    assert sum(grid["runs"]) == 7 * 11


@pytest.mark.parametrize("goal", [(15, 7), (-3, 7), (5, 12), (5, -9)])
def test_walls_round_the_world_hold_in_contact_mode(goal) -> None:
    robot = {"kinematics": {"name": "omni"}, "shape": {"name": "circle", "radius": 0.3}, "behavior": {"name": "dash"}}
    world = {"width": 12, "height": 8, "collision_mode": "contact", "boundary": "walls"}
    data = {"world": world, "robot": {**robot, "state": [5, 4, 0], "goal": [*goal]}}
    env = irsim.make(read(data).scenario, headless=True, log_level="ERROR")
    env.rollout(150, until_done=False)
    x, y = env.robot.state[:2, 0]
    assert 0.3 - 1e-3 <= x <= 11.7 + 1e-3
    assert 0.3 - 1e-3 <= y <= 7.7 + 1e-3
    assert min(x, 12 - x, y, 8 - y) < 0.31
