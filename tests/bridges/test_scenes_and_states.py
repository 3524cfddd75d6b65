"""Scenes and states, live, recorded and as JSON, and scenes that change while bridges are connected."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.bridges.base import Bridge, BridgeError
from irsim.bridges.connect import connect
from irsim.bridges.json_lines.bridge import feedback_of, motion_as_json, scene_as_json, state_as_json
from irsim.bridges.recorded import recorded_scene, recorded_states
from irsim.bridges.state import Motion, WorldState, world_state
from irsim.common.outline import Circle, Line, Polygon
from irsim.objects.describe import agent_rows, describe_scene
from irsim.simulation.scene import SceneDescription
from tests.bridges.peer import Peer
from tests.bridges.scenes import environment, recorded

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
    return environment(SCENE, seed=3).simulation


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
        [polygon] = describe_scene(environment(text, seed=0).simulation).agents[0].parts
        assert sorted(polygon.corners.tolist()) == sorted(corners)  # type: ignore[union-attr]
        x, y = polygon.corners.T  # type: ignore[union-attr]
        assert x @ np.roll(y, -1) - y @ np.roll(x, -1) == pytest.approx(4)


def test_a_scene_as_json_has_bodies_and_runs_of_cells(scene: SceneDescription) -> None:
    data = json.loads(json.dumps(scene_as_json(scene), allow_nan=False))
    assert data["version"] == 1
    car, disk, line, pair, walls = data["agents"]
    assert car["parts"] == [{"polygon": scene.agents[0].parts[0].corners.tolist()}]  # type: ignore[union-attr]
    assert disk["parts"] == [{"circle": [0, 0, 0.3]}]
    assert line["parts"] == [{"line": [[0, 0], [1, 1], [2, 0]], "closed": False}]
    assert [list(part) for part in pair["parts"]] == [["circle"], ["polygon"]]
    assert walls["parts"][0]["closed"]
    assert (car["name"], car["wheelbase"], car["lidars"][0]["beams"]) == ("robot_0", 1.2, 7)
    assert walls["mass"] is None, "infinite"
    runs = np.array(data["grid"]["runs"])
    solid = np.repeat(np.arange(len(runs)) % 2 == 1, runs).reshape(data["grid"]["size"])
    assert np.array_equal(solid, scene.grid.occupied)  # type: ignore[union-attr]


def test_states_and_motions_as_json() -> None:
    running = simulation()
    running.step()
    state = world_state(running, agent_rows(running))
    data = json.loads(json.dumps(state_as_json(state), allow_nan=False))
    assert (data["version"], data["step"], data["time"]) == (1, 1, pytest.approx(0.1))
    assert np.array_equal(data["pose"], state.pose)
    assert np.array_equal(np.array(data["goal"], float), state.goal, equal_nan=True), "null without a goal"
    ranges = np.array(data["ranges"]["robot_0/0"], np.float32)
    assert np.array_equal(ranges, state.ranges["robot_0/0"])
    motion = Motion(1, 0.1, state.control, state.pose, state.twist)
    assert np.array_equal(json.loads(json.dumps(motion_as_json(motion)))["pose"], state.pose)


def test_feedback_is_read_from_json() -> None:
    heard = feedback_of({"commands": {"a": [1, 2, 3]}, "ranges": {"a/0": [1, None]}, "end": "over"})
    assert (heard.commands, heard.end) == ({"a": (1, 2, 3)}, "over")
    assert heard.ranges["a/0"].tolist() == [1, np.inf]


@pytest.mark.parametrize(
    "data",
    [
        [], {"poses": {"a": [1, 2]}}, {"poses": {"a": [1, 2, float("inf")]}}, {"goals": 3}, {"jump": {}},
        {"ranges": {"a": ["x"]}},
    ],
)  # fmt: skip
def test_wrong_feedback(data: Any) -> None:
    with pytest.raises(BridgeError, match="bridge-failed"):
        feedback_of(data)


def test_a_recorded_run_is_the_live_one() -> None:
    run, live = recorded(SCENE, 20, seed=3), simulation()
    plain, again = (
        scene_as_json(scene) | {"about": "", "name": ""} for scene in (describe_scene(live), recorded_scene(run))
    )
    assert json.dumps(again) == json.dumps(plain)
    rows = agent_rows(live)
    for state in recorded_states(run):
        assert np.array_equal(state.pose, world_state(live, rows).pose)
        live.step()
    assert [state.step for state in recorded_states(run, every=8)] == [0, 8, 16, 20]


RANDOM = """
world: {width: 10, height: 10, step_time: 0.1}
robot:
  - {kinematics: {name: diff}, state: [1, 5, 0], goal: [9, 5, 0], shape: {name: circle, radius: 0.3},
     behavior: {name: dash}}
obstacle:
  - number: 2
    distribution: {name: random, range_low: [2, 6, 0], range_high: [9, 9, 0]}
    shape: {name: polygon, random_shape: true, avg_radius_range: [0.3, 0.8]}
"""


class Renewed(Bridge):
    """Keeps the scenes and the steps that it is told of."""

    name = "renewed"

    def open(self, scene: Any, start: WorldState) -> None:
        self.scenes, self.told = [scene], list[str]()

    def renew(self, scene: Any, start: WorldState) -> None:
        assert np.isfinite(start.pose).all()
        self.scenes.append(scene)
        self.told.append("scene")

    def push(self, state: WorldState) -> None:
        self.told.append(f"step {state.step}")


def make(more: str = "") -> Any:
    return environment(RANDOM + more, seed=3)


def corners(scene: Any) -> list[Any]:
    return [agent.parts[0].corners.tolist() for agent in scene.agents[1:]]


def test_a_drawn_scene_is_told_before_its_first_state() -> None:
    env, bridge = make(), Renewed()
    with connect(env, [bridge]) as connection:
        env.step()
        env.reset(random=True)
        env.step()
        assert connection.scene is bridge.scenes[1]
    assert bridge.told == ["step 1", "scene", "step 0", "step 1"]
    first, second = bridge.scenes
    assert corners(first) != corners(second)
    assert [agent.pose for agent in second.agents[1:]] != [agent.pose for agent in first.agents[1:]]
    again = make()
    again.reset(random=True)
    with connect(again, [fresh := Renewed()]):
        pass
    assert corners(fresh.scenes[0]) == corners(second), "the scene is what a new connection would be told"


def test_a_reset_to_the_same_scene_tells_only_the_state() -> None:
    env = make()
    with connect(env, [bridge := Renewed()]):
        env.step()
        env.reset()
    assert bridge.told == ["step 1", "step 0"]


def test_a_scene_that_is_drawn_before_the_first_step_is_told() -> None:
    env = make()
    with connect(env, [bridge := Renewed()]):
        env.reset(random=True)
    assert bridge.told == ["scene", "step 0"]


def test_another_seed_is_another_scene() -> None:
    env, bridge = make(), Renewed()
    with connect(env, [bridge]):
        env.set_random_seed(8)
        env.reset()
    assert len(bridge.scenes) == 2
    assert bridge.scenes[1].seed == 8


def test_a_program_gets_the_new_scene() -> None:
    with Peer(lambda message: None) as peer:
        env = make(f"bridges: [{{name: json_lines, address: '{peer.address}'}}]\n")
        with irsim.connect(env):
            env.step()
            env.reset(random=True)
            env.step()
    assert peer.kinds() == ["scene", "state", "scene", "state", "state", "end"]
    first, second = (message["scene"] for message in peer.received if message["kind"] == "scene")
    assert first["agents"][1]["parts"] != second["agents"][1]["parts"]


def test_objects_that_come_and_go_are_told() -> None:
    env, bridge = make(), Renewed()
    with connect(env, [bridge]):
        env.step()
        env.add_object(env.create_obstacle(shape={"name": "circle", "radius": 0.2}, state=[5, 2, 0]))
        env.step()
        env.delete_object(env.obstacle_list[0].id)
        env.step()
    assert [len(scene.agents) for scene in bridge.scenes] == [3, 4, 3]
    assert bridge.told[-1] == "step 3"


def test_a_bridge_needs_the_object_that_it_moves() -> None:
    env, bridge = make(), Renewed()
    bridge.agents = frozenset([env.obstacle_list[1].name])
    with connect(env, [bridge]):
        env.delete_object(env.obstacle_list[1].id)
        with pytest.raises(BridgeError, match="which the scene does not have any more"):
            env.step()


@pytest.mark.parametrize("steps", [0, 3])
def test_measurements_go_on_in_the_new_scene(steps: int) -> None:
    """A world with a bridge and one without look the same."""
    plain, watched = make(), make()
    with connect(watched, [Renewed()]):
        for env in (plain, watched):
            for _ in range(steps):
                env.step()
            env.reset(random=True)
            env.step()
    assert np.array_equal(plain.simulation.pose, watched.simulation.pose)
