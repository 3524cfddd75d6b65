"""Co-simulation with MuJoCo: irsim decides, MuJoCo moves."""

from __future__ import annotations

import ctypes.util
import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image, ImageSequence
from shapely import MultiPoint
from typer.testing import CliRunner

import irsim
from irsim.bridges import solids
from irsim.bridges.base import BridgeError
from irsim.bridges.doctor import examine
from irsim.bridges.mujoco.bridge import make
from irsim.bridges.mujoco.contacts import MujocoReport
from irsim.bridges.mujoco.mjcf import choose_agents, write_mjcf
from irsim.bridges.options import read_bridges
from irsim.cli.app import app
from irsim.components.bridges.mujoco import Mujoco
from irsim.objects.describe import describe_scene
from tests.bridges.scenes import environment, gallery, motion_of, state_of

pytest.importorskip("mujoco")
pytestmark = pytest.mark.interop

TEMPLATES = Path(__file__).resolve().parents[2] / "templates"
SQUARE = """
world: {width: 12, height: 8, step_time: 0.1, boundary: walls}
robot:
  - {name: rover, kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 4, 0], goal: [11, 4, 0],
     vel_max: [1, 1.5], vel_min: [0, -1.5], behavior: {name: rvo},
     sensors: [{name: lidar2d, number: 181, angle_range: 6.28, range_max: 8, offset: [0.05, -0.02, 0.4]}]}
obstacle:
  - {shape: {name: polygon, vertices: [[0, 0], [2, 0], [2, 1.5], [1, 0.4], [0, 1.5]]}, state: [4, 0.5, 0]}
  - {shape: {name: linestring, vertices: [[0, 0], [1, 0.5], [2, 0]]}, state: [7, 7, 0]}
  - {number: 4, kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, distribution: {name: manual},
     state: [[6, 2, 0], [6, 6, 0], [9, 4.5, 0], [8, 2.5, 0]], goal: [[6, 6, 0], [6, 2, 0], [2, 4.5, 0], [3, 5.5, 0]],
     vel_max: [0.6, 0.6], vel_min: [-0.6, -0.6], behavior: {name: rvo}}
"""
POCKET = """
world: {{width: 12, height: 8, step_time: 0.1}}
robot:
  - {{name: rover, kinematics: {{name: {drive}, wheelbase: 0.3}}, shape: {shape}, state: [1, 4, 0],
     goal: [{goal}, 4, 0], behavior: {{name: dash}}}}
obstacle:
  - {{name: trap, state: [6, 4, 0],
     shape: {{name: polygon, vertices: [[-2, -2], [2, -2], [2, 2], [-2, 2], [-2, 0.8], [1, 0.8], [1, -0.8],
                                        [-2, -0.8]]}}}}
"""
SHAPES = {
    "circle": "{name: circle, radius: 0.3}",
    "rectangle": "{name: rectangle, length: 0.6, width: 0.4}",
    "polygon": "{name: polygon, vertices: [[-0.3, -0.3], [0.4, 0], [-0.3, 0.3], [-0.1, 0]]}",
    "compound": "{name: compound, parts: [{name: circle, radius: 0.2}, {name: rectangle, length: 0.6, width: 0.2}]}",
}


def pocket(goal: float, drive: str = "diff", shape: str = "circle") -> str:
    """A robot drives into a pocket, which ends at x = 7, or through its end."""
    return POCKET.format(drive=drive, shape=SHAPES[shape], goal=goal)


def drive_through(
    text: str, steps: int = 400, seed: int = 1, **options: Any
) -> tuple[np.ndarray[Any, Any], MujocoReport, list[np.ndarray[Any, Any]]]:
    """Poses (T, N, 3), the report, and the scans of the first lidar, of an episode with the bridge."""
    env = environment(text, seed)
    bridge = make(Mujoco(**options))
    poses, scans = [env.simulation.pose.copy()], []
    try:
        with irsim.connect(env, [bridge]):
            while not env.done() and len(poses) <= steps:
                env.step()
                poses.append(env.simulation.pose.copy())
                scans.append(env.simulation.ranges.copy())
    finally:
        env.end(ending_time=0.0)
    return np.array(poses), bridge.report, scans


def test_a_robot_among_people_arrives_and_both_lidars_agree() -> None:
    poses, report, _ = drive_through(SQUARE)
    assert np.hypot(*(poses[-1, 0, :2] - (11, 4))) < 0.3
    assert report.contacts == report.ghost_contacts == 0
    assert report.lidar_beams > 5000
    assert report.lidar_one_sided == 0
    assert report.lidar_largest_m < 0.01
    assert report.lidar_median_m < 1e-5
    assert report.step_difference_largest_m < 0.08
    assert report.warnings == {}
    moved = np.abs(poses[1:, 0] - poses[:-1, 0]).sum()
    assert 10 < moved < 30


def test_the_same_seed_gives_the_same_trace_and_another_seed_another_one() -> None:
    rough = {"slip": 0.3, "command_noise": 0.1, "latency": 0.05, "lidar": "replace", "range_noise": 0.02}
    one, _, scans = drive_through(SQUARE, 60, **rough)
    same, _, again = drive_through(SQUARE, 60, **rough)
    other, _, _ = drive_through(SQUARE, 60, seed=2, **rough)
    np.testing.assert_array_equal(one, same)
    np.testing.assert_array_equal(scans, again)
    assert np.abs(one - other).max() > 1e-3


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("drive", ["diff", "omni", "omni_angular", "acker"])
def test_every_drive_with_every_shape_reaches_the_end_of_a_pocket_without_contact(drive: str, shape: str) -> None:
    poses, report, _ = drive_through(pocket(5.5, drive, shape), 150)
    assert np.hypot(*(poses[-1, 0, :2] - (5.5, 4))) < 0.3
    assert (report.contacts, report.ghost_contacts) == (0, 0)


def test_a_contact_that_is_there_is_found_and_is_no_ghost() -> None:
    poses, report, _ = drive_through(pocket(9.5), 80)
    assert report.contacts == 1
    assert report.ghost_contacts == 0
    [contact] = report.first_contacts
    assert set(contact["objects"]) == {"rover", "trap"}
    assert poses[-1, 0, 0] == pytest.approx(6.7, abs=0.02)  # the pocket ends at 7, the robot has a radius of 0.3


def test_a_ghost_contact_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    def hull(corners: Any) -> list[Any]:
        return [np.array(MultiPoint(corners).convex_hull.exterior.coords)[:-1][::-1]]

    monkeypatch.setattr(solids, "convex_pieces", hull)
    _, report, _ = drive_through(pocket(5.5), 80)
    assert report.ghost_contacts > 0
    assert report.first_contacts[0]["gap"] > 0.1


def test_slip_slows_a_robot_down_and_latency_delays_it() -> None:
    text = pocket(5.5)
    plain, *_ = drive_through(text, 20)
    slipping, *_ = drive_through(text, 20, slip=0.5)
    late, *_ = drive_through(text, 20, latency=0.5)
    icy, *_ = drive_through(text, 20, friction=0.02)
    travelled = [float(poses[20, 0, 0]) - 1 for poses in (plain, slipping, late, icy)]
    assert travelled[0] == pytest.approx(1.93, abs=0.05)  # 2 s at 1 m/s, less the time in which it speeds up
    assert travelled[1] == pytest.approx(0.75 * travelled[0], abs=0.1)
    assert travelled[2] == pytest.approx(travelled[0] - 0.5, abs=0.02)
    assert 0.2 < travelled[3] < 0.4  # motors use 90 % of the grip: 0.02 * 0.9 * 9.81 * 2**2 / 2 = 0.35 m
    assert (late[:6, 0, 0] < 1.001).all()


def test_scans_are_replaced_by_those_of_mujoco() -> None:
    _, _, plain = drive_through(SQUARE, 5, lidar="off")
    _, _, replaced = drive_through(SQUARE, 5, lidar="replace")
    _, _, noisy = drive_through(SQUARE, 5, lidar="replace", range_noise=0.05)
    hit = np.array(plain) < 8
    assert np.abs(np.array(replaced) - np.array(plain)).max() < 0.02
    assert 0.04 < (np.array(noisy) - np.array(replaced))[hit].std() < 0.06


def test_a_box_is_pushed_away() -> None:
    text = (TEMPLATES / "box-pushing" / "scenario.yaml").read_text(encoding="utf-8")
    poses, report, _ = drive_through(text, 200)
    assert poses[-1, 1, 0] - poses[0, 1, 0] > 3
    assert {"pusher", "box", "barrel"} == set(report.objects)
    assert report.ghost_contacts == 0


def test_people_push_a_standing_robot_in_mujoco() -> None:
    scene = gallery()
    bridge = make(Mujoco(agents=["rover"]))
    bridge.open(scene, state_of(scene))
    state = state_of(scene)
    for step in range(40):
        pose = state.pose.copy()
        pose[5, 0] += 0.1
        motion = motion_of(scene, state)
        motion.pose[5] = pose[5]
        feedback = bridge.exchange(motion)
        assert feedback is not None
        pose[0] = feedback.poses["rover"]
        state = state_of(scene, pose, step + 1)
        bridge.push(state)
    bridge.close()
    assert state.pose[0, 0] > 0.3
    assert bridge.report.contacts == 1


def test_objects_that_are_not_in_the_world_touch_nothing_and_come_back() -> None:
    scene = gallery()
    start = state_of(scene)
    start.pose[[0, 5]] = np.nan
    bridge = make(Mujoco())
    bridge.open(scene, start)
    state = start
    for step in range(10):
        feedback = bridge.exchange(motion_of(scene, state, slider=(0.5, 0.0)))
        assert feedback is not None
        assert "rover" not in feedback.poses
        pose = state.pose.copy()
        for name, where in feedback.poses.items():
            pose[scene.agent(name).index] = where
        state = state_of(scene, pose, step + 1)
        bridge.push(state)
    pose = state.pose.copy()
    pose[0] = (-5.0, 7.0, 0.5)
    bridge.push(state_of(scene, pose, 11))
    feedback = bridge.exchange(motion_of(scene, state_of(scene, pose, 11), rover=(0.0, 0.0)))
    assert feedback is not None
    assert feedback.poses["rover"] == pytest.approx((-5.0, 7.0, 0.5), abs=1e-3)
    bridge.close()
    assert bridge.report.contacts == 0


def test_another_episode_starts_at_rest_and_without_old_commands() -> None:
    env = environment(pocket(5.5), seed=1)
    runs = []
    with irsim.connect(env, [make(Mujoco(latency=0.3))]):
        for _ in range(2):
            env.reset()
            runs.append([])
            for _ in range(12):
                env.step()
                runs[-1].append(env.simulation.pose[0].copy())
    env.end(ending_time=0.0)
    np.testing.assert_allclose(runs[0], runs[1], atol=1e-3)
    assert runs[1][2] == pytest.approx((1, 4, 0), abs=1e-3)


def test_a_hundred_robots() -> None:
    text = """
world: {width: 40, height: 40, step_time: 0.1}
robot:
  - {number: 100, distribution: {name: circle, radius: 17, center: [20, 20]}, kinematics: {name: diff},
     shape: {name: circle, radius: 0.25}, behavior: {name: dash}, sensors: [{name: lidar2d, number: 20}]}
"""
    poses, report, _ = drive_through(text, 15)
    assert len(report.objects) == 100
    assert report.lidar_largest_m < 0.01
    assert (np.hypot(*(poses[-1] - poses[0])[:, :2].T) > 0.5).all()


@pytest.mark.parametrize("library", ["egl", "osmesa"])
def test_a_video_is_drawn_without_a_window(library: str) -> None:
    if library == "egl" and ctypes.util.find_library("EGL") is None:
        pytest.skip("there is no libEGL")
    Path("scene.yaml").write_text(SQUARE, encoding="utf-8")
    option = "{name: mujoco, video: film.gif, camera: top, size: [160, 120], report: found.json}"
    command = [sys.executable, "-m", "irsim", "run", "scene.yaml", "--steps", "6", "--bridge", option, "--json"]
    variables = {**os.environ, "MUJOCO_GL": library}
    done = subprocess.run(command, capture_output=True, text=True, env=variables, timeout=120, check=False)
    assert done.returncode in (0, 1), done.stderr
    told = json.loads(done.stdout)  # nothing else is on standard output
    assert told["steps"] == 6
    assert any("mujoco: 0 contacts" in note for note in told["notes"])
    with Image.open("film.gif") as film:
        assert film.size == (160, 120)
        frames = [np.asarray(frame.convert("L"), dtype=float) for frame in ImageSequence.Iterator(film)]
    assert len(frames) == 7
    assert frames[0].std() > 20
    assert np.abs(frames[0] - frames[6]).max() > 50  # the robot has moved
    assert json.loads(Path("found.json").read_text())["steps"] == 6
    assert not Path("MUJOCO_LOG.TXT").exists()


def test_errors_say_what_to_write() -> None:
    scene, start = gallery(), state_of(gallery())
    for key, value, message in (
        ("agents", ["rovr"], "no object 'rovr'"),
        ("camera", "botom", "no camera 'botom'"),
        ("video", "film.txt", "files of videos are"),
    ):
        options: dict[str, Any] = {key: value}
        bridge = make(Mujoco(**options))
        with pytest.raises(BridgeError, match=message):
            bridge.open(scene, start)
        bridge.close()
    with pytest.raises(BridgeError, match=r"'x.sh' is not a valid value of 'report'.* Fix: .*report\.json"):
        read_bridges(["{name: mujoco, report: x.sh}"])
    assert not list(Path().iterdir())


def test_physics_that_become_unstable_are_an_error() -> None:
    scene, start = gallery(), state_of(gallery())
    bridge = make(Mujoco())
    bridge.open(scene, start)
    assert bridge.physics is not None
    bridge.physics.data.qvel[0] = np.inf
    with pytest.raises(BridgeError, match="unstable"):
        bridge.exchange(motion_of(scene, start))
    bridge.close()
    bridge.close()
    assert not list(Path().iterdir())  # MuJoCo would write a log


def test_the_doctor_lets_a_ball_fall() -> None:
    [health] = examine(["mujoco"])
    assert (health.part, health.state) == ("mujoco", "ready")
    assert "fell 0.05" in health.text


def test_every_template_is_a_model_that_mujoco_simulates() -> None:
    import mujoco

    loaded = 0
    for path in sorted(TEMPLATES.glob("*/scenario.yaml")):
        env = irsim.make(str(path), headless=True, log_level="ERROR")
        scene = describe_scene(env.simulation)
        env.end(ending_time=0.0)
        model = mujoco.MjModel.from_xml_string(write_mjcf(scene, choose_agents(scene, None), Mujoco()))
        data = mujoco.MjData(model)
        for _ in range(20):
            mujoco.mj_step(model, data)
        assert np.isfinite(data.qpos).all(), path
        assert not data.warning.number.any(), path
        assert np.abs(data.qvel).max(initial=0) < 0.2, path  # nothing starts in contact
        loaded += 1
    assert loaded >= 40


def test_what_the_page_says_works() -> None:
    page = (TEMPLATES.parent / "skills/irsim-runner/bridges/mujoco.md").read_text(encoding="utf-8")
    blocks = {lang: re.findall(rf"```{lang}\n(.*?)```", page, re.DOTALL) for lang in ("bash", "yaml", "python")}
    Path("hall.yaml").write_text(SQUARE, encoding="utf-8")
    commands = [line for block in blocks["bash"] for line in block.splitlines() if line.startswith("irsim")]
    assert len(commands) == 3
    for command in commands:
        done = CliRunner().invoke(app, shlex.split(command)[1:])
        assert done.exit_code == 0, (command, done.output)
    assert Path("hall.xml").stat().st_size > 5000
    seen: dict[str, Any] = {}
    exec(blocks["python"][0], seen)
    assert seen["mujoco"].report.steps > 50
    [options] = blocks["yaml"]
    Path("hall.yaml").write_text(SQUARE + options, encoding="utf-8")
    done = CliRunner().invoke(app, ["run", "hall.yaml", "--steps", "20"])
    assert done.exit_code in (0, 1), done.output
    assert json.loads(Path("report.json").read_text(encoding="utf-8"))["steps"] == 20
