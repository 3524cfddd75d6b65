"""Cells that a map leaves unknown: beams and bodies pass them, planners and random places keep out of them."""

from __future__ import annotations

import copy
import pickle
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import strategies as st
from PIL import Image

import irsim
import irsim._core as core
from irsim import api
from irsim.api import validate
from irsim.bridges.maps.ros_server import export_map
from irsim.components.maps._grid import map_grid, merged
from irsim.components.maps._site import Raster
from irsim.navigation.geodesic import Geodesics
from irsim.navigation.map import coarsen
from irsim.objects.describe import describe_scene
from irsim.scenario.perturbation import perturbed, read_perturbations
from irsim.scenario.read import read
from irsim.simulation.simulation import Simulation
from tests.effort import for_all

STRIP = (4.0, 6.0)
"""x of the unknown strip, which leaves open what lies above y = 8."""


def write_map(folder: Path, robots: str = "", unknown: str | None = "unknown", world: str = "") -> Path:
    """A world of 10 x 10 m: a wall at x > 9, and a strip of unknown cells from y = 0 to 8."""
    grey = np.full((100, 100), 254, np.uint8)  # rows along y, downwards
    grey[:, 90:] = 0
    grey[20:, 40:60] = 205
    Image.fromarray(grey).save(folder / "map.png")
    (folder / "map.yaml").write_text("image: map.png\nresolution: 0.1\norigin: [0, 0, 0]\n")
    option = "" if unknown is None else f", unknown: {unknown}"
    file = folder / "world.yaml"
    file.write_text(f"world: {{obstacle_map: {{name: ros, path: map.yaml{option}}}{world}}}\n{robots}")
    return file


def robot(behavior: str = "{name: dash}", start: str = "[2, 2]", goal: str = "[8, 2]", more: str = "") -> str:
    return f"""robot:
  - kinematics: {{name: omni}}
    shape: {{name: circle, radius: 0.2}}
    state: {start}
    goal: {goal}
    behavior: {behavior}
{more}"""


def test_cells_are_free_occupied_or_unknown_as_the_user_says(tmp_path) -> None:
    cells = {
        choice: read(write_map(tmp_path, unknown=choice)).scenario.grid.cells
        for choice in ("free", "occupied", "unknown")
    }
    assert {name: (one.count, one.closed_count) for name, one in cells.items()} == {
        "free": (1000, 1000),
        "occupied": (2600, 2600),
        "unknown": (1000, 2600),
    }
    assert cells["free"].unknown is None
    unknown = np.zeros((100, 100), bool)
    unknown[40:60, :80] = True
    np.testing.assert_array_equal(cells["unknown"].unknown, unknown)
    np.testing.assert_array_equal(irsim.make(write_map(tmp_path), display=False).get_map().grid < 0, unknown)


def test_a_choice_that_is_not_made_is_said(tmp_path) -> None:
    [note] = read(write_map(tmp_path, unknown=None)).diagnostics
    assert (note.code, note.severity) == ("map-read-as", "hint")
    assert "16% of its cells are unknown and count as free" in note.message
    assert not read(write_map(tmp_path)).diagnostics


@pytest.mark.parametrize(("unknown", "seen"), [("unknown", 7.0), ("free", 7.0), ("occupied", 2.0)])
def test_beams_pass(tmp_path, unknown, seen) -> None:
    more = "    sensors: [{name: lidar2d, number: 3, range_max: 20, angle_range: 1.0e-6}]\n"
    env = irsim.make(write_map(tmp_path, robot("null", more=more), unknown), display=False)
    env.step(np.zeros((2, 1)))
    np.testing.assert_allclose(env.get_lidar_scan()["ranges"], seen, atol=1e-6)


def test_sight_passes(tmp_path) -> None:
    fov = "    fov: 1\n    fov_radius: 9\n"
    robots = robot("null", more=fov) + "  - {kinematics: {name: omni}, state: [8, 2], goal: [8, 3]}\n"
    seen = {}
    for unknown in ("unknown", "occupied"):
        env = irsim.make(write_map(tmp_path, robots, unknown), display=False)
        seen[unknown] = env.robot_list[0].fov_detect_object(env.robot_list[1])
    assert seen["unknown"]


def test_bodies_drive_through(tmp_path) -> None:
    env = irsim.make(write_map(tmp_path, robot(start="[3, 2]", goal="[7, 2]")), display=False)
    for _ in range(100):
        env.step()
    assert env.robot.arrive
    assert not env.robot.collision


PLANNERS = ("astar", "jps", "rrt", "rrt_star", "informed_rrt_star", "prm")


@pytest.mark.parametrize("planner", PLANNERS)
def test_planners_go_round(tmp_path, planner) -> None:
    file = write_map(tmp_path, robot(f"{{name: follow, planner: {planner}}}"), world=", time_limit: 60")
    env = irsim.make(file, display=False, seed=3)
    crossed = []
    for _ in range(600):
        env.step()
        x, y = env.robot.state[:2, 0]
        if STRIP[0] < x < STRIP[1]:
            crossed.append(y)
        if env.done():
            break
    assert env.robot.arrive
    assert min(crossed) > 8.0 + 0.2 - 1e-6


def test_planners_of_scripts_go_round(tmp_path) -> None:
    from irsim.lib import AStarPlanner

    env = irsim.make(write_map(tmp_path, robot()), display=False)
    for resolution in (0.1, 0.35):  # the cells of the map, and blocks of them
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)
            path = AStarPlanner(env.get_map(resolution)).planning([2, 2], [8, 2], show_animation=False)
        crossing = path[1][(path[0] > STRIP[0]) & (path[0] < STRIP[1])]
        assert crossing.size
        assert crossing.min() > 8.0


def test_no_way_into_the_unknown(tmp_path) -> None:
    file = write_map(tmp_path, robot("{name: follow}", goal="[5, 2]"))
    env = irsim.make(file, display=False)
    env.step()
    assert [event.kind for event in env.events] == ["no_path"]


def test_distances_along_ways_go_round(tmp_path) -> None:
    simulation = Simulation(read(write_map(tmp_path, robot())).scenario, [0])
    length = Geodesics(simulation).length(np.array([2.0, 2.0]), np.array([8.0, 2.0]), 0.2)
    assert length > 2 * np.hypot(2.0, 6.0)
    free = Simulation(read(write_map(tmp_path, robot(), "free")).scenario, [0])
    assert Geodesics(free).length(np.array([2.0, 2.0]), np.array([8.0, 2.0]), 0.2) == pytest.approx(6.0)


def outside(place: Any, radius: float) -> bool:
    """Whether a disc at a place keeps out of the strip."""
    return bool(np.hypot(max(STRIP[0] - place[0], place[0] - STRIP[1], 0.0), max(place[1] - 8.0, 0.0)) >= radius - 1e-9)


@for_all(40, seed=st.integers(0, 2**31))
def test_random_starts_and_goals_keep_out(tmp_path_factory, seed) -> None:
    crowd = """robot:
  - number: 8
    distribution: {name: square_crossing, width: 7, height: 9, center: [4.5, 5]}
    kinematics: {name: omni}
    shape: {name: circle, radius: 0.2}
    behavior: {name: dash}
  - number: 12
    distribution: {name: random, range_low: [0, 0, 0], range_high: [9, 10, 6]}
    kinematics: {name: omni}
    shape: {name: circle, radius: 0.2}
    behavior: {name: dash}
obstacle:
  - number: 4
    distribution: {name: random, range_low: [0, 0, 0], range_high: [9, 10, 6]}
    kinematics: {name: omni}
    shape: {name: circle, radius: 0.2}
    behavior: {name: dash, wander: true, range_low: [0, 0, -3], range_high: [9, 10, 3]}
"""
    env = irsim.make(write_map(tmp_path_factory.mktemp("map"), crowd), display=False, seed=seed)
    for _ in range(2):
        for one in env.objects[:24]:
            assert outside(one.state[:2, 0], 0.2)
            assert outside(one.goal[:2, 0], 0.2)
        env.reset()


def test_starts_that_spread_keep_out(tmp_path) -> None:
    scenario = read(write_map(tmp_path, robot(start="[3.6, 2]"))).scenario
    spread = perturbed(scenario, read_perturbations("position=1.0"))
    starts = np.array([Simulation(spread, [seed]).pose[0, :2] for seed in range(20)])
    assert np.ptp(starts[:, 0]) > 0.5
    assert all(outside(place, 0.2) for place in starts)


def test_places_that_scripts_draw_keep_out(tmp_path) -> None:
    obstacle = "obstacle: {number: 3, shape: {name: circle, radius: 0.2}, state: [1, 9, 0]}\n"
    env = irsim.make(write_map(tmp_path, robot() + obstacle), display=False, seed=1)
    for _ in range(10):
        env.random_obstacle_position([0, 0, 0], [9, 10, 3], non_overlapping=True)
        env.robot.set_random_goal(
            env.obstacle_list, free=True, goal_check_radius=0.2, range_limits=[[0, 0, 0], [9, 9, 3]]
        )
        assert all(outside(one.state[:2, 0], 0.2) for one in env.obstacle_list if one.shape == "circle")
        assert outside(env.robot.goal[:2, 0], 0.2)


def test_the_summary_says_how_much_is_unknown(tmp_path) -> None:
    report = validate(write_map(tmp_path, robot()))
    assert report.counts["map_unknown"] == 1600
    assert "(10 % occupied, 16 % unknown)" in report.summary


def test_a_block_is_occupied_or_unknown_before_it_is_free() -> None:
    values = np.array([[0.0, -1.0, 0.0, 0.0], [100.0, 0.0, -1.0, 0.0]])
    np.testing.assert_array_equal(merged(values, 2), [[100.0, -1.0]])
    np.testing.assert_array_equal(coarsen(values, 1, 2), [[100.0, -1.0]])
    grid = map_grid(Raster(values), 4.0, 2.0, (0.0, 0.0), 2)
    assert (grid.cells.count, grid.cells.closed_count) == (1, 2)


def test_copies_keep_them() -> None:
    cells = core.OccupancyGrid(np.zeros((3, 2), np.uint8), (0, 0), (1, 1), np.eye(3, 2, dtype=np.uint8))
    for again in (pickle.loads(pickle.dumps(cells)), copy.deepcopy(cells)):
        np.testing.assert_array_equal(again.unknown, np.eye(3, 2))
    with pytest.raises(ValueError, match="same shape"):
        core.OccupancyGrid(np.zeros((3, 2), np.uint8), (0, 0), (1, 1), np.zeros((2, 2), np.uint8))


def findings(file: Path) -> dict[str, Any]:
    return {one.code: one for one in validate(file).findings}


def test_starts_and_goals_in_the_unknown_are_found(tmp_path) -> None:
    goal = findings(write_map(tmp_path, robot("{name: follow}", goal="[5, 2]")))["goal-blocked"]
    assert "inside an unknown part of the map" in goal.message
    assert "is free" in goal.fix
    start = findings(write_map(tmp_path, robot("{name: follow}", start="[5, 2]")))["initial-overlap"]
    assert "starts in an unknown part of the map" in start.message
    assert "is free" in start.fix
    assert not {"goal-blocked", "initial-overlap"} & set(findings(write_map(tmp_path, robot("{name: follow}"))))


@pytest.mark.parametrize(("mode", "image"), [("trinary", "pgm"), ("raw", "pgm"), ("scale", "png")])
def test_maps_for_the_map_server_keep_them(tmp_path, mode, image) -> None:
    scenario = read(write_map(tmp_path)).scenario
    export_map(scenario, tmp_path / "back.yaml", mode=mode, image=image)
    back = read({"world": {"obstacle_map": {"name": "ros", "path": str(tmp_path / "back.yaml"), "unknown": "unknown"}}})
    np.testing.assert_array_equal(back.scenario.grid.cells.unknown, scenario.grid.cells.unknown)
    np.testing.assert_array_equal(back.scenario.grid.cells.occupied, scenario.grid.cells.occupied)


def test_scenes_of_other_programs_know_them(tmp_path) -> None:
    scene = describe_scene(Simulation(read(write_map(tmp_path)).scenario, [0]))
    np.testing.assert_array_equal(scene.grid.levels == -1, scene.grid.unknown)
    assert (scene.grid.unknown.sum(), scene.grid.occupied.sum()) == (1600, 1000)


def test_pictures_show_them_in_grey(tmp_path) -> None:
    api.render(write_map(tmp_path), tmp_path / "look.png")
    pixels = np.asarray(Image.open(tmp_path / "look.png").convert("RGB")).reshape(-1, 3).astype(int)
    unknown, occupied = ((abs(pixels - level) < 6).all(axis=1).sum() for level in ((219, 225, 231), (143, 154, 165)))
    assert 1.5 < unknown / occupied < 1.7, "1.6 times as many cells are unknown as occupied"


def test_arrays_of_scripts_may_have_unknown_cells() -> None:
    values = np.zeros((20, 20))
    values[8:12, :16] = -1
    values[19] = 100
    data = {"world": {"width": 10, "height": 10, "obstacle_map": values}, "robot": [{"state": [1, 1, 0]}]}
    env = irsim.Env(read(data).scenario, headless=True)
    cells = env.scenario.grid.cells
    assert (cells.count, int(cells.unknown.sum())) == (20, 64)
    assert env.get_map(0.5).is_collision(shapely.Point(5, 1))
    assert not env.get_map(0.5).is_collision(shapely.Point(5, 9))
