"""What the table of a scenario says about goals, sensors and beams."""

from __future__ import annotations

from pathlib import Path

from irsim.api.read_input import read_input
from irsim.validation.scene_table import scene_table
from irsim.validation.scene_text import scene_lines

WATCH = """\
world: {width: 20, height: 10, step_time: 0.1}
robot:
  - name: watcher
    shape: {name: circle, radius: 0.3}
    state: [1, 5, 0]
    sensors: [{name: fmcw_lidar2d, range_max: 10, angle_range: 2.0943951, number: 241, motion_compensate: true,
               velocity_noise_std: 0.05}]
  - name: parker
    kinematics: {name: omni_angular}
    state: [3, 1, 0]
    goal: [9, 1, 3.14]
    arrive_mode: state
    behavior: {name: dash}
obstacle:
  - {name: box, shape: {name: rectangle, length: 1, width: 4}, state: [6, 5]}
  - name: walker
    kinematics: {name: omni}
    state: [15, 2]
    waypoints: [[15, 8], [12, 8]]
    appear_time: 2.5
    behavior: {name: dash}
"""
SWAP = """\
world: {width: 3, height: 3}
robot:
  - number: 2
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.3}
    distribution: {name: random, range_low: [0.4, 0.4, -3.14], range_high: [2.6, 2.6, 3.14]}
    behavior: {name: dash}
  - number: 2
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.3}
    distribution: {name: random, range_low: [0.4, 0.4, -3.14], range_high: [2.6, 2.6, 3.14]}
    behavior: {name: dash}
"""


def lines(text: str, tmp_path: Path) -> str:
    file = tmp_path / "scene.yaml"
    file.write_text(text, encoding="utf-8")
    scenario, _ = read_input(file, None, strict=True)
    return "\n".join(scene_lines(scene_table(scenario).model_dump(), {}, 0))


def test_sensors_and_their_beams_are_told(tmp_path: Path) -> None:
    found = lines(WATCH, tmp_path)
    assert "fmcw_lidar2d 120 deg, 10 m, 241 beams, motion_compensate, velocity noise 0.05" in found
    (line,) = [line for line in found.splitlines() if line.startswith("Lidar of watcher")]
    hit, box = int(line.split(": ")[1].split(" of ")[0]), int(line.split("box ")[1].split(",")[0])
    assert 0 < box <= hit < 241
    assert abs(box - 241 * 2 * 23.96 / 120) < 3  # the box is seen under atan(2 / 4.5) to both sides


def test_goals_whose_heading_counts_and_waypoints_are_told(tmp_path: Path) -> None:
    found = lines(WATCH, tmp_path)
    assert "goal (9.00, 1.00, 3.14), heading counts" in found
    assert "2 waypoints, first (15.00, 8.00), last (12.00, 8.00)" in found
    assert "appears at 2.5 s" in found


def test_seeds_in_which_goals_overlap_are_counted(tmp_path: Path) -> None:
    assert "overlap" not in lines(SWAP, tmp_path)
    ghosts = SWAP.replace(
        "behavior: {name: dash}", "behavior: {name: dash}, unobstructed: true".replace(", ", "\n    ")
    )
    (line,) = [line for line in lines(ghosts, tmp_path).splitlines() if "overlap" in line]
    assert 0 < int(line.split(" in ")[1].split(" of ")[0]) < 20
