"""Scenes and states as files, live and of recorded runs."""

from __future__ import annotations

import json
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.api import read_scenario
from irsim.bridges.base import BridgeError
from irsim.bridges.recorded import recorded_scene, recorded_states
from irsim.bridges.scene_files import (
    feedback_as_json,
    feedback_of,
    load_scene,
    load_states,
    save_scene,
    save_states,
    scene_as_json,
    scene_of,
    state_as_json,
    state_of,
)
from irsim.bridges.state import Feedback, world_state
from irsim.common.outline import Circle, Line, Polygon
from irsim.objects.describe import agent_rows, describe_scene
from irsim.runs import open_run
from irsim.simulation.scene import SceneDescription

SCENE = """
world: {width: 12, height: 8, offset: [-2, 1], boundary: walls, collision_mode: unobstructed,
  obstacle_map: {name: perlin, resolution: 0.5, fill: 0.1}}
robot:
  - {kinematics: {name: acker, wheelbase: 1.2}, shape: {name: rectangle, length: 2, width: 1}, state: [0, 3, 0, 0],
     goal: [8, 3], vel_max: [1, 0.5], behavior: {name: dash}, color: red, sensors: [{name: lidar2d, number: 7}]}
  - {kinematics: {name: omni}, state: [0, 6, 1], goal: [8, 6], shape: {name: circle, radius: 0.3}}
obstacle:
  - {shape: {name: linestring, vertices: [[0, 0], [1, 1], [2, 0]]}, state: [3, 7, 0]}
  - {state: [4, 7, 0], shape: {name: compound, parts: [{name: circle, radius: 0.2},
      {name: rectangle, length: 1, width: 0.1}]}}
"""


def simulation() -> Any:
    scenario, _ = read_scenario(text=SCENE, strict=True)
    return irsim.Env(scenario, seed=3, headless=True, log_level="ERROR").simulation


@pytest.fixture(scope="module")
def scene() -> SceneDescription:
    return describe_scene(simulation())


def test_a_scene_has_bodies_map_and_walls(scene: SceneDescription) -> None:
    assert [agent.name for agent in scene.agents] == ["robot_0", "robot_1", "obstacle_2", "obstacle_3", "boundary"]
    car, disk, line, pair, walls = scene.agents
    assert car.parts[0].corners.shape == (4, 2)  # type: ignore[union-attr]
    assert car.wheelbase == 1.2
    assert car.color == (1, 0, 0)
    assert disk.parts == (Circle((0, 0), 0.3),)
    assert isinstance(line.parts[0], Line)
    assert [type(part) for part in pair.parts] == [Circle, Polygon]
    assert isinstance(walls.parts[0], Line)
    assert walls.parts[0].closed
    assert scene.walls
    assert (scene.low, scene.high) == ((-2, 1), (10, 9))
    assert scene.grid is not None
    assert scene.grid.occupied.shape == (24, 16)
    assert 0 < scene.grid.occupied.sum() < 24 * 16


def test_polygons_of_a_scene_run_counterclockwise() -> None:
    corners = [[0, 0], [1, 2], [2, 0]]
    for given in (corners, corners[::-1]):
        text = f"obstacle: {{shape: {{name: polygon, vertices: {given}}}, state: [5, 5, 0]}}"
        made = irsim.Env(read_scenario(text=text, strict=True)[0], seed=0, headless=True, log_level="ERROR")
        [polygon] = describe_scene(made.simulation).agents[0].parts
        assert sorted(polygon.corners.tolist()) == sorted(corners)  # type: ignore[union-attr]
        x, y = polygon.corners.T  # type: ignore[union-attr]
        assert x @ np.roll(y, -1) - y @ np.roll(x, -1) == pytest.approx(4)


def test_a_scene_crosses_json(scene: SceneDescription, tmp_path: Path) -> None:
    save_scene(scene, tmp_path / "scene.json")
    again = load_scene(tmp_path / "scene.json")
    assert scene_as_json(again) == scene_as_json(scene)
    unwritten = {"row": -1, "static": False, "threshold": 0.0, "look": None}
    assert again.agents[1] == replace(scene.agents[1], **unwritten)  # type: ignore[arg-type]
    assert np.array_equal(again.grid.occupied, scene.grid.occupied)  # type: ignore[union-attr]


def test_states_cross_npz(tmp_path: Path) -> None:
    running = simulation()
    rows, states = agent_rows(running), []
    for _ in range(5):
        states.append(world_state(running, rows))
        running.step()
    save_states(states, tmp_path / "states.npz")
    again = load_states(tmp_path / "states.npz")
    assert [state.step for state in again] == [0, 1, 2, 3, 4]
    for one, two in zip(states, again, strict=True):
        assert np.array_equal(one.pose, two.pose)
        assert np.array_equal(one.ranges["robot_0/0"], two.ranges["robot_0/0"])


@pytest.mark.parametrize(
    "part",
    [Line(np.zeros((1, 2))), Polygon(np.zeros((2, 2))), Circle((0.0, 0.0), 0.0)],
    ids=["line of one point", "polygon of two corners", "circle without a radius"],
)
def test_bodies_without_extent_are_refused(scene: SceneDescription, part: Any) -> None:
    data = scene_as_json(replace(scene, agents=(replace(scene.agents[1], index=0, parts=(part,)),)))
    with pytest.raises(BridgeError, match="of agent 0 has"):
        scene_of(data)


@pytest.mark.parametrize(
    "change",
    [
        {"version": 99},
        {"agents": None},
        {"agents": [{}]},
        {"grid": {"size": [2, 2], "cell": [1, 1], "origin": [0, 0], "runs": [10**12]}},
        {"grid": {"size": [10**7, 10**7], "cell": [1, 1], "origin": [0, 0], "runs": [3]}},
        {"grid": {"size": [10**6, 10**6], "cell": [1, 1], "origin": [0, 0], "runs": [10**12]}},
        {"low": [float("nan"), 0]},
        {"name": 3},
        {"step_time": 0},
        {"about": 3},
        {"unknown": 1},
    ],
)
def test_a_wrong_scene_is_refused(scene: SceneDescription, change: dict[str, Any]) -> None:
    with pytest.raises(BridgeError, match="bridge-file"):
        scene_of({**scene_as_json(scene), **change})


@pytest.mark.parametrize(
    "change",
    [
        {"role": "king"},
        {"index": 7},
        {"radius": -1},
        {"pose": [None, 0, 0]},
        {"parts": [{"circle": [0, 0, -1]}]},
        {"parts": [{"polygon": [[0, 0], [1, 1]]}]},
        {"lidars": [{"beams": 10**12}]},
        {"name": "walls"},
    ],
)
def test_a_wrong_agent_is_refused(scene: SceneDescription, change: dict[str, Any]) -> None:
    data = scene_as_json(scene)
    agent = next(one for one in data["agents"] if one["lidars"])
    if "lidars" in change:
        change = {"lidars": [{**agent["lidars"][0], **change["lidars"][0]}]}
    if "name" in change:
        change = {"name": next(one["name"] for one in data["agents"] if one is not agent)}
    agent |= change
    with pytest.raises(BridgeError, match="bridge-file"):
        scene_of(data)


def test_states_and_feedback_cross_json() -> None:
    running = simulation()
    running.step()
    state = world_state(running, agent_rows(running))
    again = state_of(json.loads(json.dumps(state_as_json(state), allow_nan=False)))
    assert state_as_json(again) == state_as_json(state)
    assert np.array_equal(again.ranges["robot_0/0"], state.ranges["robot_0/0"])
    assert np.array_equal(again.goal, state.goal, equal_nan=True)
    said = Feedback(commands={"a": (1, 2, 3)}, ranges={"a/0": np.array([1, np.inf], dtype=np.float32)}, end="over")
    heard = feedback_of(json.loads(json.dumps(feedback_as_json(said), allow_nan=False)))
    assert feedback_as_json(heard) == feedback_as_json(said)
    assert heard.ranges["a/0"].tolist() == [1, np.inf]


@pytest.mark.parametrize("change", [{"version": 2}, {"pose": [[1, 2, 3]]}, {"time": None}, {"ranges": {"a": [[1]]}}])
def test_a_wrong_state_is_refused(change: dict[str, Any]) -> None:
    running = simulation()
    data = state_as_json(world_state(running, agent_rows(running)))
    with pytest.raises(BridgeError, match="not a state of irsim"):
        state_of({**data, **change})


def test_a_file_that_has_no_states(tmp_path: Path) -> None:
    running, file = simulation(), tmp_path / "states.npz"
    with pytest.raises(BridgeError, match="there are no states"):
        save_states([], file)
    assert not file.exists()
    save_states([world_state(running, agent_rows(running))], file)
    good = dict(np.load(file))
    changes: list[dict[str, Any]] = [
        {"version": np.int64(99)}, {"pose": np.zeros((1, 1, 3))}, {"pose": np.array(["a"])},
        {"twist": np.full(good["twist"].shape, np.inf)}, {"time": np.array([np.nan])},
        {"ranges:robot_0/0": np.full((1, 3), np.nan)}, {"ranges:robot_0/0": np.zeros(3)},
    ]  # fmt: skip
    for change in changes:
        np.savez(file, **(good | change))
        with pytest.raises(BridgeError, match="not a file of states"):
            load_states(file)
    np.savez(file, **{key: value for key, value in good.items() if key != "version"})
    with pytest.raises(BridgeError, match="'version' is missing"):
        load_states(file)


def test_a_damaged_file_of_states(tmp_path: Path) -> None:
    running, file = simulation(), tmp_path / "states.npz"
    save_states([world_state(running, agent_rows(running))], file)
    whole = file.read_bytes()
    flipped = bytes(byte ^ 255 if 200 < place < len(whole) - 400 and place % 37 == 0 else byte
                    for place, byte in enumerate(whole))  # fmt: skip
    header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000,), }".ljust(117) + b"\n"
    with zipfile.ZipFile(tmp_path / "huge.npz", "w") as archive:
        archive.writestr("step.npy", b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header)
    huge = (tmp_path / "huge.npz").read_bytes()
    for content in (b"", b"PK\x03\x04junk", whole[: len(whole) // 2], whole[:-10], flipped, huge, b"\x80\x04."):
        file.write_bytes(content)
        with pytest.raises(BridgeError, match="not a file of states"):
            load_states(file)


@pytest.mark.parametrize("content", ["", "[", "[]", "{}", '"text"', "[" * 100_000])
def test_a_file_that_is_no_scene(tmp_path: Path, content: str) -> None:
    (tmp_path / "scene.json").write_text(content)
    with pytest.raises(BridgeError, match="bridge-file"):
        load_scene(tmp_path / "scene.json")


@pytest.mark.parametrize(
    "data",
    [
        [],
        {"poses": {"a": [1, 2]}},
        {"poses": {"a": [1, 2, float("inf")]}},
        {"goals": 3},
        {"jump": {}},
        {"ranges": {"a": ["x"]}},
    ],
)
def test_wrong_feedback(data: Any) -> None:
    with pytest.raises(BridgeError, match="bridge-failed"):
        feedback_of(data)


def test_a_recorded_run_is_the_live_one(tmp_path: Path) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text(SCENE)
    irsim.run(file, seed=3, steps=20, record=tmp_path / "run")
    run = open_run(tmp_path / "run")
    live = simulation()
    plain = scene_as_json(describe_scene(live))
    recorded = scene_as_json(recorded_scene(run))
    for one in (plain, recorded):
        one.pop("about")
        one.pop("name")
    assert json.dumps(recorded) == json.dumps(plain)
    rows = agent_rows(live)
    for state in recorded_states(run):
        assert np.array_equal(state.pose, world_state(live, rows).pose)
        live.step()
    assert [state.step for state in recorded_states(run, every=8)] == [0, 8, 16, 20]
