"""MuJoCo after a reset that draws another scene: its shapes are the new ones."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from PIL import Image, ImageSequence

import irsim
from irsim.bridges.mujoco.bridge import make
from irsim.components.bridges.mujoco import Mujoco
from tests.bridges.scenes import environment

pytest.importorskip("mujoco")
pytestmark = pytest.mark.interop

ROOM = """
world: {width: 12, height: 8, step_time: 0.1}
robot:
  - {name: rover, kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 4, 0], goal: [11, 4, 0],
     behavior: {name: dash}, sensors: [{name: lidar2d, number: 181, angle_range: 6.28, range_max: 8}]}
obstacle:
  - number: 6
    distribution: {name: random, range_low: [2, 0.5, 0], range_high: [11, 2.8, 0]}
    shape: {name: polygon, random_shape: true, avg_radius_range: [0.3, 0.6]}
"""


def geometry(bridge: Any) -> list[tuple[float, ...]]:
    """Places and sizes of all solids, and their corners."""
    model = bridge.physics.model
    rows = [*np.hstack([model.geom_pos, model.geom_size]), *model.mesh_vert]
    return [tuple(np.round(row, 9).tolist()) for row in rows]


def test_the_lidars_of_both_agree_in_each_new_scene() -> None:
    env, bridge = environment(ROOM, seed=5), make(Mujoco(lidar="compare"))
    seen = []
    with irsim.connect(env, [bridge]):
        for _ in range(3):
            for _ in range(8):
                env.step()
            seen.append(geometry(bridge))
            assert bridge.report.lidar_beams > 0
            assert bridge.report.lidar_one_sided == 0
            assert bridge.report.lidar_largest_m < 0.01
            env.reset(random=True)
        assert bridge.report.steps == 24
    assert seen[0] != seen[1]
    assert seen[1] != seen[2]
    env.end(ending_time=0.0)


def test_the_model_of_the_same_scene_stays() -> None:
    env, bridge = environment(ROOM, seed=5), make(Mujoco())
    with irsim.connect(env, [bridge]):
        physics = bridge.physics
        env.step()
        env.reset()
        assert bridge.physics is physics
        env.reset(random=True)
        assert bridge.physics is not physics
    env.end(ending_time=0.0)


def test_a_run_in_a_new_scene_is_that_of_a_new_connection() -> None:
    runs = []
    for connected_before in (True, False):
        env = environment(ROOM, seed=5)
        if not connected_before:
            env.reset(random=True)
        with irsim.connect(env, [make(Mujoco())]):
            if connected_before:
                env.reset(random=True)
            for _ in range(20):
                env.step()
        runs.append(env.simulation.pose.copy())
        env.end(ending_time=0.0)
    np.testing.assert_allclose(runs[0], runs[1], atol=1e-9)


def test_a_changed_body_is_that_of_mujoco_too() -> None:
    """The obstacle in front of the robot grows, and the robot meets it sooner."""
    reached = []
    for radius in (0.3, 1.0):
        text = ROOM[: ROOM.index("obstacle:")] + (
            "obstacle:\n  - {name: column, shape: {name: circle, radius: 0.3}, state: [5, 4, 0]}\n"
        )
        env = environment(text, seed=5)
        with irsim.connect(env, [bridge := make(Mujoco())]):
            env.step()
            if radius > 0.3:
                env.obstacle_list[0].set_original_geometry(shapely.Point(0, 0).buffer(radius))
            for _ in range(60):
                env.step()
            assert bridge.report.contacts >= 1
            assert bridge.report.ghost_contacts == 0
        reached.append(float(env.robot.state[0, 0]))
        env.end(ending_time=0.0)
    assert reached[0] == pytest.approx(4.5, abs=0.05)
    assert reached[1] == pytest.approx(3.8, abs=0.05)


def test_a_film_goes_on() -> None:
    """In a process of its own, because MuJoCo chooses how it draws when it is imported."""
    program = """
import sys
import irsim
from irsim.bridges.mujoco.bridge import make
from irsim.components.bridges.mujoco import Mujoco
from tests.bridges.scenes import environment
env = environment(sys.argv[1], seed=5)
with irsim.connect(env, [make(Mujoco(video="run.gif", size=[160, 120], camera="top"))]):
    for _ in range(2):
        for _ in range(5):
            env.step()
        env.reset(random=True)
"""
    variables = {**os.environ, "MUJOCO_GL": "osmesa", "PYTHONPATH": str(Path(__file__).resolve().parents[2])}
    subprocess.run([sys.executable, "-c", program, ROOM], env=variables, check=True, timeout=120)
    with Image.open("run.gif") as film:
        frames = [np.asarray(frame.convert("RGB")).astype(int) for frame in ImageSequence.Iterator(film)]
    assert len(frames) == 13
    assert (np.abs(frames[2] - frames[8]).max(axis=2) > 60).mean() > 0.005, "the obstacles of the new scene are seen"
