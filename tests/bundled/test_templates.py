"""Every bundled template: described, valid in both senses, runs as it says, can be drawn, varies as promised."""

from __future__ import annotations

import ast
import functools
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
import yaml
from PIL import Image

import irsim
from irsim.bundled import templates
from irsim.bundled.templates import Template, store
from irsim.common import data_files as resources
from tests.bundled.draw import draw
from tests.effort import some

pytestmark = pytest.mark.one_python

ALL = templates.names()
MODELINE = "# yaml-language-server: $schema=../../schema/scenario.schema.json"


@pytest.fixture(scope="module", autouse=True)
def templates_are_read_once() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(store, "load", functools.cache(store.load))
        yield


@pytest.fixture(params=ALL)
def template(request: pytest.FixtureRequest) -> Template:
    return templates.load(request.param)


@pytest.fixture(scope="session")
def validator() -> Any:
    schema = json.loads(resources.schema_file().read_text(encoding="utf-8"))
    return jsonschema.Draft202012Validator(schema)


def filled(name: str, folder: Path, **given: object) -> Path:
    path = folder / f"{name}.yaml"
    path.write_text(templates.fill(templates.load(name), given), encoding="utf-8")
    return path


def extremes(template: Template) -> list[dict[str, object]]:
    """Settings with one parameter at an end of its range, or at another choice."""
    settings: list[dict[str, object]] = []
    for name, parameter in template.parameters.items():
        ends = [*parameter.choices, parameter.min, parameter.max]
        settings += [{name: end} for end in ends if end is not None and end != parameter.default]
    return settings


SITUATIONS = """
head-on, crossing, overtaking, doorway, bottleneck, T-junction, group, queue, exploration, pushing, sorting, parking,
planner, mixed fleet, wandering, CrowdNav, perlin, image map, fmcw, maze, warehouse, crowd, training, compound, lidar,
dead end, staggered, random benchmark, merging, station platform, perpendicular streams, line crossing, field of view,
vision cone, evacuation, bend, slalom, curriculum, kidnapped robot, wrong belief, wheel slip, odometry drift, f1tenth,
race, noisy sensors, detector, delay
"""


@pytest.mark.parametrize("words", SITUATIONS.replace("\n", " ").strip().split(", "))
def test_every_situation_is_found_by_its_words(words: str) -> None:
    assert templates.find([words], every=True)


def test_described_well_enough_to_be_found(template: Template) -> None:
    assert template.title
    assert template.purpose.endswith(".")
    assert len(template.tags) >= 5
    assert template.parameters
    for parameter in template.parameters.values():
        assert parameter.description
        assert parameter.type != "number" or parameter.unit, "a number has a unit"


def test_every_parameter_changes_something_and_no_expression_reads_another(template: Template) -> None:
    trees = [ast.parse(expression, mode="eval") for expression in template.sets.values()]
    read = {node.id for tree in trees for node in ast.walk(tree) if isinstance(node, ast.Name)}
    assert read - {"pi", "abs", "cos", "max", "min", "round", "sin", "sqrt"} == set(template.parameters)


def test_the_default_parameters_give_the_file_itself(template: Template) -> None:
    assert template.text.splitlines()[0] == MODELINE
    assert templates.fill(template) == template.text


HINTS = {
    "noisy-warehouse": ["reacts-late"],
    "perlin-forest": ["narrow-passage"],
    "random-polygons": ["dash-into-obstacle"],
}
"""Findings that are meant so."""


def test_valid_without_a_warning(template: Template, validator: Any) -> None:
    report = irsim.validate(templates.scenario_file(template.name), strict=True)
    assert [finding.code for finding in report.findings if finding.severity != "hint"] == []
    assert {finding.code for finding in report.findings} <= {"no-behavior", *HINTS.get(template.name, ())}
    assert report.valid
    assert [error.message for error in validator.iter_errors(yaml.safe_load(template.text))] == []


@pytest.mark.slow
def test_valid_and_possible_at_the_ends_of_every_parameter(template: Template, validator: Any, tmp_path: Path) -> None:
    for given in extremes(template):
        path = filled(template.name, tmp_path, **given)
        text = path.read_text(encoding="utf-8")
        assert irsim.run(path, steps=1, seed=0).steps == 1, given
        report = irsim.validate(text=text)
        assert report.valid, given
        assert [finding.message for finding in report.findings if finding.severity == "warning"] == [], given
        assert validator.is_valid(yaml.safe_load(text)), given


@pytest.mark.parametrize("seed", [0, 1])
def test_ends_as_it_says(template: Template, seed: int) -> None:
    result = irsim.run(templates.scenario_file(template.name), seed=seed)
    assert result.outcome in template.outcomes
    endless = "timeout" in template.outcomes or "loop: true" in template.text or "collision" in template.outcomes
    assert 0 < result.sim_time < result.time_limit or endless
    assert {finding.code for finding in result.warnings} <= {"no-behavior", *HINTS.get(template.name, ())}


@pytest.mark.slow
def test_draws(template: Template, tmp_path: Path) -> None:
    result = irsim.render(templates.scenario_file(template.name), tmp_path / "t.png", steps=20, size=300)
    with Image.open(result.files[0]) as picture:
        assert 280 <= max(picture.size) <= 300
        assert len(picture.convert("RGB").getcolors(1 << 20) or []) > 20


@pytest.mark.parametrize("name", some(ALL))
def test_has_a_picture_of_its_start(name: str, tmp_path: Path) -> None:
    stored = templates.picture_file(name)
    assert stored.stat().st_size < 40_000
    draw(name, tmp_path / "now.png")
    with Image.open(stored) as known, Image.open(tmp_path / "now.png") as now:
        assert known.size == now.size
        pixels = [np.asarray(picture.convert("L").resize((100, 80)), dtype=float) for picture in (known, now)]
    assert np.abs(pixels[0] - pixels[1]).mean() < 2.0, "python -m tests.bundled.draw"  # Matplotlib's letters vary


def test_the_car_finds_whichever_bay_is_free(tmp_path: Path) -> None:
    for bay in (4, 5, 7, 8):
        result = irsim.run(filled("car-park", tmp_path, bay=bay))
        assert result.outcome == "success"
        assert result.robots[0].pose[0] == pytest.approx(3 * bay - 1, abs=0.5)


RUNS: dict[str, list[tuple[dict[str, Any], str]]] = {
    # Corridors of any width, streams of any density, people of any speed.
    "corridor-passing": [({"width": 1.2, "radius": 0.2}, "success"), ({"width": 1.6}, "success"),
        ({"width": 3, "length": 30}, "success"), ({"length": 60, "speed": 0.5}, "success")],
    "merging": [({"gap": 1, "speed": 0.3}, "success"), ({"gap": 1.4, "speed": 2}, "success"),
        ({"gap": 3, "speed": 0.9}, "success")],
    "station-platform": [({"walking": 0.4}, "success"), ({"walking": 1.5, "speed": 0.3}, "success"),
        ({"walking": 0.7, "speed": 2}, "success")],
    # The time limit grows with the way.
    "circle-swap": [({"robots": 2, "speed": 0.1}, "success"), ({"robots": 3, "circle": 30}, "success")],
    "car-park": [({"speed": 0.2}, "success")],
    "crossing": [({"courier_speed": 0.2}, "collision")],
    "lidar-explorer": [({"speed": 0.1}, "success")],
    "obstacle-field": [({"speed": 0.1}, "success")],
    "overtaking": [({"slow": 0.1}, "success")],
    "race": [({"slow": 0.6}, "success"), ({"grip": 0.1}, "collision")],
    # A robot that goes by the turns of its wheels is lost after the patch; localization copes with any.
    "slippery-hall": [({"knows": "odometry"}, "collision"), ({"slip": 0.8}, "success"), ({"spread": 0.3}, "success")],
    "noisy-warehouse": [({"position": 0.15}, "success"), ({"seen": 0.3}, "success"), ({"speed": 0.3}, "success")],
    "random-polygons": [({"size": 60}, "collision")],
    # Only robots that plan get out of the trap.
    "u-trap": [({"behavior": "follow"}, "success"), ({"behavior": "dash"}, "collision"),
        *(({"behavior": behavior}, "timeout") for behavior in ("orca", "rvo", "sfm"))],
}  # fmt: skip


@pytest.mark.parametrize(("name", "given", "outcome"), [(name, *run) for name, runs in RUNS.items() for run in runs])
def test_other_parameters_end_as_they_should(name: str, given: dict[str, Any], outcome: str, tmp_path: Path) -> None:
    assert irsim.run(filled(name, tmp_path, **given), seed=0).outcome == outcome


def test_every_map_of_the_forest_has_a_way_through(tmp_path: Path) -> None:
    seeds = set()
    for number in range(1, 7):
        path = filled("perlin-forest", tmp_path, map=number, fill=0.27)
        seeds.add(yaml.safe_load(path.read_text(encoding="utf-8"))["world"]["obstacle_map"]["seed"])
        assert irsim.run(path).outcome == "success", number
    assert len(seeds) == 6


def test_people_cross_at_their_times_and_in_the_way_of_the_robot(tmp_path: Path) -> None:
    path = filled("crossing-pedestrians", tmp_path, gap=1.5, walking=1.0)
    env = irsim.make(path, display=False, headless=True)
    heights = []
    for _ in range(60):
        env.step()
        heights.append([float(person.state[1, 0]) for person in env.obstacle_list])
    env.end(ending_time=0)
    for k in range(4):
        assert heights[15 * (k + 1) - 1][k] == pytest.approx(0, abs=1e-6)
    text = templates.load("crossing-pedestrians").text
    path.write_text(text.replace("{name: orca, timeHorizon: 3, safe_radius: 0.2}", "{name: dash}"), encoding="utf-8")
    assert irsim.run(path).outcome == "collision"


def test_another_behavior_brings_its_own_options(tmp_path: Path) -> None:
    path = filled("random-crossing", tmp_path, behavior="rvo", robots=4)
    [robots] = yaml.safe_load(path.read_text(encoding="utf-8"))["robot"]
    assert robots["behavior"] == {"name": "rvo", "vxmax": 1, "vymax": 1, "neighbor_threshold": 4}
    assert irsim.run(path, seed=0).outcome == "success"
    first, second = (irsim.make(path, display=False, headless=True, seed=seed) for seed in (0, 1))
    assert (first.robot.state != second.robot.state).any()


def test_the_first_scan_measures_how_fast_people_walk() -> None:
    env = irsim.make(templates.scenario_file("fmcw-watch"), display=False, headless=True, seed=0)
    speeds = env.get_lidar_scan()["radial_velocity"]
    env.end(ending_time=0)
    assert speeds.min() < -0.8
    assert speeds.max() > 0.8


def test_streams_cross_to_and_fro_for_ever(tmp_path: Path) -> None:
    result = irsim.run(filled("cross", tmp_path, endless=True))
    assert (result.outcome, result.sim_time) == ("success", result.time_limit)
    assert min(robot.path_length for robot in result.robots) > 40


def test_a_kidnapped_robot_strays_far_and_completes_its_tour() -> None:
    strayed = []
    for seed in range(5):
        env = irsim.make(templates.scenario_file("kidnapped"), display=False, headless=True, seed=seed)
        error, robot = 0.0, env.robot
        while not env.done():
            env.step()
            error = max(error, math.dist(robot.sensors[0].data[:2], robot.state[:2, 0]))
        env.end(ending_time=0)
        assert robot.arrive
        strayed.append(error)
    assert sum(error > 1.5 for error in strayed) >= 3


def test_odometry_is_wrong_after_the_slippery_patch_and_localization_is_not() -> None:
    env = irsim.make(templates.scenario_file("slippery-hall"), display=False, headless=True, seed=0)
    while not env.done():
        env.step()
    robot = env.robot_list[0]
    by_wheels, on_the_map = (math.dist(sensor.data[:2], robot.state[:2, 0]) for sensor in robot.sensors)
    env.end(ending_time=0)
    assert robot.arrive
    assert by_wheels > 2
    assert on_the_map < 0.3


def test_the_fastest_car_starts_last_and_wins_the_race() -> None:
    result = irsim.run(templates.scenario_file("race"))
    times = {robot.name: robot.time_to_goal for robot in result.robots}
    assert times["red"] < times["blue"] < times["yellow"]
