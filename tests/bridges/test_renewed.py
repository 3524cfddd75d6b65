"""Scenes that change while bridges are connected: a reset draws another one, or a script changes a body."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import irsim
from irsim.bridges.base import Bridge, BridgeError
from irsim.bridges.connect import connect
from irsim.bridges.state import WorldState
from tests.bridges.peer import Peer
from tests.bridges.scenes import environment

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
