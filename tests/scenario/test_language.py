"""The language as users write it: every form that 2.12 takes, what it tolerates, and what is new."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import BaseModel

from irsim.components.options import CustomKinematics
from irsim.options import registry
from irsim.options.base import field_docs
from irsim.scenario.model.scenario import Entry, Scenario
from irsim.scenario.read import read
from irsim.scenario.resolve.resolved import ObjectRecord

COMPLETE = """
world: {height: 20, width: 20, step_time: 0.1, offset: [-10, -10], collision_mode: stop, sample_time: 0.2, seed: 3,
        obstacle_map: {name: perlin, resolution: 0.2, fill: 0.01, seed: 3}, fog_map: true,
        plot: {viewpoint: [0, 0], saved_figure: {dpi: 80}}}
robot:
  - kinematics: {name: acker, mode: steer}
    shape: {name: rectangle, length: 4.6, width: 1.6, wheelbase: 3}
    state: [-8, -8, 0, 0]
    goal: [[[0, 0, 0], [8, 8, 0]]]
    vel_max: [4, 1]
    vel_min: [-4, -1]
    goal_threshold: 0.5
    behavior: {name: dash, loop: true}
    sensors: [{type: lidar2d, number: 91, range_max: 8, angle_range: 6.28, plot: {alpha: 0.2}}]
    color: cycle
  - number: 4
    kinematics: {name: omni}
    shape: [{name: circle, radius: 0.3}]
    distribution: {name: circle, radius: 6, center: [0, 0]}
    group_behavior: {name: orca, safe_radius: 0.2, sidestep: 10}
    color: [r, g, b]
    tags: [pedestrian]
obstacle:
  - number: 5
    distribution: {name: random, range_low: [-9, -9, -3.14], range_high: [9, 9, 3.14]}
    kinematics: {name: diff}
    behavior: {name: rvo, wander: true, range_low: [-9, -9, -3.14], range_high: [9, 9, 3.14]}
    shape: [{name: polygon, random_shape: true, is_convex: true, avg_radius_range: [0.3, 0.8]}]
  - shape: {name: linestring, vertices: [[0, 0], [3, 0], [3, 3]]}
    state: [0, 0, 0]
    unobstructed: true
    plot: {show_text: true, text_position: [0.1, 0.1]}
  - shape: {name: compound, parts: [{name: circle, radius: 0.5, pose: [1, 0, 0]}]}
    state: [4, -4, 0]
    mass: [2.0]
gui: {keyboard: {backend: mpl, key_lv_max: 2.0}, mouse: {zoom_factor: 1.2}}
custom: {anything: [1, {goes: null}]}
"""
"""Every section, and keys of each kind of value."""


def accepted(text: str) -> None:
    """Valid as far as the language goes, with nothing to remark."""
    left_out = ("not-yet-simulated", "default-state")
    diagnostics = [item for item in read(text, strict=True).diagnostics if item.code not in left_out]
    assert diagnostics == []


def test_every_section_at_once() -> None:
    accepted(COMPLETE)


@pytest.mark.parametrize(
    "entry",
    [
        "sensors: [{type: lidar2d, alpha: 0.2, color: red}]",
        "sensors: [{}]",
        "sensors: [{name: fmcw_lidar2d, motion_compensate: true, plot: {velocity_linewidth: 2, no_hit_alpha: 0.1}}]",
        "sensors: [{name: contact2d, force_scale: 0.1}, {name: lidar2d, has_velocity: true}]",
        "sensors: null",
        "behavior: {name: sfm, vmax: 1.2, relaxation_time: 0.4, n_angular: 3}",
        "behavior: {name: rvo, vxmax: 1, vymax: 1, mode: hrvo, neighbor_threshold: 5, target_roles: all}",
        "behavior: {name: orca, timeHorizon: 3}",
        "behavior: {name: follow, planner: jps, local: {name: rvo}, replan: 2}",
        "behavior: {name: follow, planner: {name: rrt_star, max_iter: 900}}",
        "behavior: [{name: dash}]",
        "group_behavior: {name: sfm, social_groups: [[0]], gaze_vision_angle: 90}",
        "plot: {show_text: true, text_position: [0, 1], traj_style: '--', trail_type: ellipse, obj_zorder: 5}",
        "plot: [{show_goal: true, goal_color: tab:blue}]",
        *(f"color: {color}" for color in ("'#1199ffcc'", "[0.1, 0.2, 0.3]", "'xkcd:sky blue'", "'0.5'")),
        "description: diff_robot0.png\n    group: 4\n    group_name: team\n    role: robot\n    unobstructed: true",
        "velocity: [0.5, 0]\n    acce: [.inf, 2]\n    mass: .inf\n    friction: 0.3\n    restitution: 1",
        "fov: 6.2832\n    fov_radius: 5\n    arrive_mode: state\n    goal_threshold: 0.3",
        "static: true\n    behavior: null",
        "state_dim: 5\n    state: [1, 1, 0, 2, 3]",
        "kinematics: [{name: omni_angular, noise: false, alpha: [0.1, 0.1, 0.1]}]\n    velocity: [1, 0, 0]",
        "tags: [pedestrian, slow]",
        "waypoints: [[2, 2], [3, 3, 1.5]]",
        "vel_min: null\n    vel_max: null\n    acce: null\n    state: null",
    ],
)
def test_keys_of_objects(entry: str) -> None:
    base = {"kinematics": "{name: diff}", "shape": "{name: circle}", "behavior": "{name: dash}"}
    if "waypoints" not in entry:
        base["goal"] = "[9, 9]"
    given = entry.replace("group_behavior", "")
    lines = [f"    {key}: {value}" for key, value in base.items() if f"{key}: " not in given.replace("show_goal: ", "")]
    world = "world: {collision_mode: contact}\n" if "contact2d" in entry else ""
    accepted(world + "robot:\n  - number: 1\n" + "\n".join(lines) + f"\n    {entry}\n")


@pytest.mark.parametrize(
    "world",
    [
        "name: yard\n  description: two robots meet\n  metadata: {author: me, version: 3}\n  status: Waiting",
        "step_mode: ' External '\n  sample_time: 0.1\n  seed: 7\n  time_limit: 60\n  boundary: walls\n  depth: 5",
        "gravity: 1.6\n  friction: 0.1\n  restitution: 0.5\n  drive_tau: 0.2\n  collision_mode: reactive",
        "obstacle_map: null\n  plot: null\n  offset: null",
        "obstacle_map: cave.png\n  mdownsample: 2",
        "obstacle_map: {name: image, path: cave.png}",
        "obstacle_map: {name: perlin, resolution: 0.1, complexity: 0.1, fractal: 2, attenuation: 0.4, seed: null}",
        "plot: {figure_pixels: [600, 400], saved_figure: {dpi: 50, format: pdf, bbox_inches: null}, no_axis: true}",
        "plot: {viewpoint: [3, 3], title: Yard, tight: false, show_title: false}",
    ],
)
def test_keys_of_the_world(world: str) -> None:
    accepted(f"world:\n  {world}\n")


def test_a_map_as_an_array() -> None:
    for cells, code in ((np.zeros((4, 4)), "map-empty"), (np.zeros(4), "map-values"), ([[0, 100]], "not-a-mapping")):
        assert [item.code for item in read({"world": {"obstacle_map": cells}}).diagnostics] == [code]
    reading = read({"world": {"obstacle_map": np.eye(3) * 51, "width": 6}})
    assert reading.diagnostics == []
    assert reading.scenario is not None
    assert [(o.name, o.shape.name) for o in reading.scenario.objects] == [("obstacle_0", "map")]


def test_tuples_and_numpy_numbers_from_python() -> None:
    reading = read({"robot": {"kinematics": {"name": "diff"}, "state": (1, 2, 0), "goal": ((1, 2), (3, 4))}})
    assert reading.scenario is not None
    assert reading.scenario.objects[0].state == [1, 2, 0]


def test_drives_of_user_code(monkeypatch: pytest.MonkeyPatch) -> None:
    drives = registry.KINEMATICS
    monkeypatch.setattr(drives, "_features", dict(drives._features))
    drives.register(CustomKinematics, name="tracked", function=lambda *_: None)
    robot = {"kinematics": {"name": "tracked", "slip": 0.2}, "behavior": {"name": "dash"}}
    reading = read({"robot": robot}, strict=True)
    assert [d for d in reading.diagnostics if d.severity != "hint"] == []
    assert reading.scenario is not None
    kinematics: Any = reading.scenario.objects[0].kinematics
    assert (kinematics.name, kinematics.slip) == ("tracked", 0.2)


@pytest.mark.parametrize("model", [Scenario, Entry, *(Scenario.model_fields[k].annotation for k in ("world", "gui"))])
def test_every_key_is_documented(model: type[BaseModel]) -> None:
    assert set(field_docs(model)) == set(model.model_fields)


def test_reading_needs_no_heavy_library(tmp_path: Path) -> None:
    code = (
        "import sys; from irsim.scenario.read import read\n"
        "r = read('robot: {kinematics: {name: diff}, shape: {name: circle}, '\n"
        "         'behavior: {name: dash}, state: [1, 1, 0], goal: [9, 9]}\\n')\n"
        "assert r.scenario is not None and not r.diagnostics\n"
        "heavy = {'matplotlib', 'shapely', 'jsonschema', 'typer', 'mcp', 'numpy'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True, cwd=tmp_path, env={**os.environ})


def test_five_hundred_polygons_are_read_at_once() -> None:
    corners = "[[1, 0], [0.6, 0.8], [-0.3, 0.9], [-1, 0.2], [-0.7, -0.7], [0.2, -0.9]]"
    entries = [
        f"  - shape: {{name: polygon, vertices: {corners}}}\n    state: [{i % 25 * 4}.5, {i // 25 * 4}.25, 0]\n"
        f"    # {'a line of explanation ' * 4}\n"
        for i in range(500)
    ]
    text = "world: {width: 100, height: 100}\nobstacle:\n" + "".join(entries)
    assert len(text) > 100_000
    read(text)
    start = time.process_time()
    reading = read(text)
    assert time.process_time() - start < 1.0  # 0.1 s on an idle machine
    assert reading.scenario is not None
    assert len(reading.scenario.objects) == 500
    assert reading.diagnostics == []


ROBOT = "robot: {{kinematics: {{name: diff}}, shape: {{name: circle}}, behavior: {{name: dash}}, {keys}}}\n"


def resolved(text: str, *, strict: bool = False) -> list[ObjectRecord]:
    scenario = read(text, strict=strict).scenario
    assert scenario is not None
    return scenario.objects


@pytest.mark.parametrize("limit", ["0.5", "[0.5]"])
def test_one_number_limits_every_component(limit: str) -> None:
    text = ROBOT.format(keys=f"vel_max: {limit}")
    assert resolved(text)[0].vel_max == [0.5, 0.5]
    assert [d.path for d in read(text).diagnostics if d.severity == "warning"] == [("robot", "vel_max")]
    assert read(text, strict=True).scenario is None


def test_null_among_goals_is_no_goal() -> None:
    pair = resolved(ROBOT.format(keys="number: 2, state: [[1, 1], [4, 4]], goal: [null, [1, 2]]"))
    assert [record.goals for record in pair] == [[], [[1.0, 2.0]]]
    assert resolved(ROBOT.format(keys="goal: null"))[0].goals == [[1.0, 9.0, 0.0]]


def test_limits_of_things_that_never_move_may_have_any_length() -> None:
    text = "obstacle: {shape: {name: circle, radius: 0.3}, state: [2, 2], vel_max: [1, 1]}\n"
    assert resolved(text, strict=True)[0].vel_max == [1, 1, 1]
