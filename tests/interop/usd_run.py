"""A recorded run with everything that a stage shows, for tests of stages."""

from __future__ import annotations

from pathlib import Path

import irsim
from irsim.runs.reading import Run, open_run

TEXT = """
world: {width: 12, height: 8, step_time: 0.1, time_limit: 6, boundary: walls, collision_mode: unobstructed_obstacles,
        obstacle_map: {name: perlin, resolution: 0.5, seed: 3, fill: 0.08}}
robot:
  - {name: "robot 1", state: [1, 4, 3], goal: [11, 4], kinematics: {name: diff}, behavior: {name: dash},
     shape: {name: rectangle, length: 0.5, width: 0.3}}
  - {name: spinner, state: [2, 1.5, 0], goal: [2.2, 1.5], kinematics: {name: omni_angular},
     shape: {name: circle, radius: 0.2}, behavior: {name: replay, times: [0, 1, 2, 3, 4, 5], poses: [[2, 1.5, 0],
     [2, 1.5, 2], [2, 1.5, 4], [2, 1.5, 6], [2, 1.5, 8], [2, 1.5, 10]]}}
obstacle:
  - {name: "robot_1", state: [6, 6, 0.3], shape: {name: polygon, vertices: [[0, 0], [1.5, 0], [1.5, 1.5], [1, 1.5],
     [1, 0.5], [0.5, 0.5], [0.5, 1.5], [0, 1.5]]}}
  - {name: wall, state: [0, 0, 0], shape: {name: linestring, vertices: [[8, 1], [9, 1], [9, 2]]}}
  - {name: disc, state: [4, 7, 0], shape: {name: circle, radius: 0.3, center: [0.1, 0]}}
  - {name: walker, kinematics: {name: omni_angular}, shape: {name: circle, radius: 0.25},
     behavior: {name: replay, times: [0.4, 1.2, 4.0], poses: [[5, 1], [5, 3], [5, 7]]}}
"""


def record(folder: Path) -> Run:
    """Run the scenario and record it in a folder."""
    (folder / "scene.yaml").write_text(TEXT)
    irsim.run(str(folder / "scene.yaml"), record=folder / "run")
    return open_run(folder / "run")
