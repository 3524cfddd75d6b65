"""Scenarios of the tests, and where their objects are in a town, by a formula of its own."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

CROWD = """
world: {{width: 20, height: 20, step_time: 0.1, control_mode: auto, collision_mode: unobstructed}}
robot:
  - {{name: guide, kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.2}}, state: [2, 10, 0],
     goal: [18, 10, 0], behavior: {{name: dash}}}}
obstacle:
  - number: 3
    distribution: {{name: manual}}
    kinematics: {{name: omni}}
    shape: {{name: circle, radius: 0.2}}
    state: [[4, 4, 0.5], [10, 16, -1.5], [16, 5, 2.5]]
    goal: [[16, 16], [10, 3], [3, 6]]
    behavior: {{name: orca}}
  - {{name: pillar, shape: {{name: circle, radius: 0.5}}, state: [10, 18, 0]}}
bridges:
  - {{name: carla, port: {port}, timeout: {timeout}, transform: {{x: 100, y: -50, yaw: 30}}{more}}}
"""
"""A robot and three pedestrians, all of them walkers."""

YARD = np.array([[0, 0], [12, 0], [12, 9], [7, 9], [7, 6], [4, 8], [0, 8], [0, 0]], dtype=float)
"""Corners of a wall in the scenario."""

DRIVE = """
world: {{width: 12, height: 9, step_time: 0.1, control_mode: auto, collision_mode: unobstructed}}
robot:
  - name: car
    kinematics: {{name: {drive}}}
    shape: {shape}
    state: {state}
    goal: {goal}
    vel_max: {vel_max}
    vel_min: {vel_min}
    behavior: {{name: dash}}
    sensors: [{{name: lidar2d, number: 181, range_max: 10, angle_range: 4.7}}]
obstacle:
  - {{name: wall, shape: {{name: linestring, vertices: {wall}}}, state: [0, 0, 0]}}
  - {{name: walker, kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.2}}, state: [9, 7, 0], goal: [9, 2],
     vel_max: [0.8, 0.8], behavior: {{name: dash}}}}
bridges:
  - {{name: carla, port: {port}, timeout: 5, transform: {{x: -20, y: 35, yaw: -70}}{more}}}
"""
"""A robot with a lidar in a yard, which someone crosses."""


def in_town(x: Any, y: Any, at: tuple[float, float, float]) -> Any:
    """(..., 2) of CARLA for points of the scenario, whose origin is at x, y [m], yaw [deg]."""
    cosine, sine = math.cos(math.radians(at[2])), math.sin(math.radians(at[2]))
    return np.stack([at[0] + cosine * x + sine * y, at[1] + sine * x - cosine * y], axis=-1)
