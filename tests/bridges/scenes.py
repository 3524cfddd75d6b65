"""A scene with every drive and every kind of footprint, for tests of bridges."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import irsim
from irsim.api import read_scenario
from irsim.bridges.state import Motion, WorldState
from irsim.common.outline import BodyPart, Circle, Line, Polygon
from irsim.runs import Run, open_run
from irsim.simulation.scene import Grid, Lidar, SceneDescription, SceneObject

__all__ = ["STAGE", "environment", "gallery", "motion_of", "record_stage", "recorded", "state_of"]

STAGE = """
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
"""A scenario with everything that a stage of OpenUSD shows."""
_U = np.array([[0, 0], [3, 0], [3, 3], [2, 3], [2, 1], [1, 1], [1, 3], [0, 3]], dtype=float)
_FENCE = np.array([[-3.0, 0.0], [3.0, 0.0], [4.0, -1.0]])
_CAR = np.array([[-0.8, -0.9], [3.8, -0.9], [3.8, 0.9], [-0.8, 0.9]])


def environment(text: str, seed: int | None = None) -> irsim.Env:
    """The environment of a scenario, without drawing."""
    return irsim.Env(read_scenario(text=text, strict=True)[0], headless=True, log_level="ERROR", seed=seed)


def recorded(text: str, steps: int | None = None, seed: int = 1) -> Run:
    """A run of a scenario, recorded below the current directory."""
    return open_run(str(irsim.run(text=text, seed=seed, steps=steps, record=True).run_id))


def record_stage(folder: Path) -> Run:
    """A run of that scenario, recorded in a folder."""
    irsim.run(text=STAGE, record=folder / "run")
    return open_run(folder / "run")


def agent(index: int, name: str, drive: str | None, parts: tuple[BodyPart, ...], **more: Any) -> SceneObject:
    plain = SceneObject(
        index=index, name=name, role="robot", drive=drive, moves=drive is not None, pose=(0.0, 0.0, 0.0), goals=(),
        parts=parts, radius=0.3, low=(-1.0, -1.0), high=(1.0, 1.0), acceleration=(math.inf, math.inf), wheelbase=None,
        mass=math.inf, color=(0.2, 0.5, 0.8),
    )  # fmt: skip
    return replace(plain, **more)


def gallery() -> SceneDescription:
    """Four robots, a U-shaped block, a person, a wall, a box that can be pushed, a drawn zone, a map and walls."""
    lidar = Lidar("rover/0", 0, (0.1, 0.05, 0.3), -3.1, 3.1, 181, 0.0, 10.0, 0.1)
    disk = (Circle((0.0, 0.0), 0.3),)
    thing: dict[str, Any] = {"role": "obstacle", "moves": False}
    agents = (
        agent(0, "rover", "diff", disk, lidars=(lidar,)),
        agent(1, "slider", "omni", disk, pose=(1.0, 3.0, 1.0)),
        agent(2, "turner", "omni_angular", disk, pose=(-2.0, 3.0, 1.0)),
        agent(3, "car", "acker", (Polygon(_CAR),), pose=(-6.0, -3.0, 0.5), radius=4.0, wheelbase=3.0),
        agent(4, "block", None, (Polygon(_U),), pose=(3.0, -4.0, 0.2), radius=4.3, **thing),
        agent(5, "person", "omni", (Circle((0.0, 0.0), 0.2),), pose=(-4.0, 0.0, 0.0), role="obstacle"),
        agent(6, "fence", None, (Line(_FENCE),), pose=(0.0, 6.0, 0.0), **thing),
        agent(7, "box", None, (Polygon(np.array([[-0.3, -0.3], [0.3, -0.3], [0.3, 0.3], [-0.3, 0.3]])),),
              pose=(2.0, 0.0, 0.0), mass=2.0, **thing),
        agent(8, "zone", None, (Circle((0.0, 0.0), 1.0),), pose=(-6.0, 6.0, 0.0), solid=False, **thing),
    )  # fmt: skip
    occupied = np.zeros((20, 20), dtype=bool)
    occupied[0, :], occupied[5:8, 19] = True, True
    grid = Grid(occupied, (1.0, 1.0), (-10.0, -10.0))
    return SceneDescription("gallery", 0.1, (-10.0, -10.0), (10.0, 10.0), agents, grid, walls=True, seed=3)


def state_of(scene: SceneDescription, pose: Any = None, step: int = 0) -> WorldState:
    """The state at the start, or with other poses."""
    count = len(scene.agents)
    where = np.array([one.pose for one in scene.agents]) if pose is None else np.array(pose, dtype=float)
    nothing, no = np.zeros((count, 3)), np.zeros(count, dtype=bool)
    return WorldState(step, step * scene.step_time, where, nothing, nothing, nothing * np.nan, no, no, no)


def motion_of(scene: SceneDescription, state: WorldState, **controls: tuple[float, ...]) -> Motion:
    """The wanted motion in the step after a state, as irsim's drives move; a car has control and steering angle."""
    control, pose = np.zeros((len(scene.agents), 3)), state.pose.copy()
    for name, given in controls.items():
        one = scene.agent(name)
        row, yaw = one.index, state.pose[one.index, 2]
        control[row, : len(given)] = given
        left = given[1] if one.drive in ("omni", "omni_angular") else 0.0
        rate = {"diff": given[-1], "omni_angular": given[-1]}.get(str(one.drive), 0.0)
        if one.drive == "acker":
            assert one.wheelbase is not None
            rate = given[0] * math.tan(given[1]) / one.wheelbase
        along = np.array([math.cos(yaw), math.sin(yaw)]) * given[0] + np.array([-math.sin(yaw), math.cos(yaw)]) * left
        pose[row] += np.array([*along, rate]) * scene.step_time
    return Motion(state.step, state.time, control, pose, (pose - state.pose) / scene.step_time)
