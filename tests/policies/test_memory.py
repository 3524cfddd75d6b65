"""What a policy remembers belongs to a robot of a simulation, also when others come and go."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import irsim
from irsim.diagnostics.errors import PolicyError
from irsim.policies import Observations, Policy
from irsim.policies.networks import save_network
from tests.policies.networks.examples import crowd, filled

FAR = """
world: {width: 100, height: 100, step_time: 0.1}
robot:
  - number: 4
    kinematics: {name: diff}
    distribution: {name: manual}
    state: [[10, 10, 0], [10, 50, 0], [50, 10, 0], [50, 50, 0]]
    goal: [[90, 10], [90, 50], [90, 20], [90, 60]]
    name: [a, b, c, d]
"""


@pytest.fixture
def scene(tmp_path: Path) -> str:
    path = tmp_path / "far.yaml"
    path.write_text(FAR)
    return str(path)


@pytest.fixture
def network(tmp_path: Path) -> str:
    data = crowd()
    data["layout"]["parts"][2]["range"] = 2.0
    save_network(tmp_path / "net.npz", filled(data))
    return str(tmp_path / "net.npz")


def paths(env: irsim.Env, steps: int) -> None:
    for _ in range(steps):
        env.step()


def test_a_removed_robot_takes_its_memory_with_it(scene: str, network: str) -> None:
    with_all, without = (irsim.make(scene, display=False, policy=network, log_level="ERROR") for _ in range(2))
    for env in (with_all, without):
        paths(env, 10)
    without.delete_object("b")
    for env in (with_all, without):
        paths(env, 10)
    kept = [robot for robot in with_all.robot_list if robot.name != "b"]
    for left, right in zip(kept, without.robot_list, strict=True):
        np.testing.assert_array_equal(left.state, right.state)


def test_one_policy_drives_two_simulations_in_turns(scene: str, network: str) -> None:
    alone = irsim.make(scene, display=False, policy=network, log_level="ERROR")
    paths(alone, 20)
    shared = irsim.open_policy(network)
    first, second = (irsim.make(scene, display=False, policy=shared, log_level="ERROR") for _ in range(2))
    paths(second, 3)
    for _ in range(20):
        first.step()
        second.step()
    for left, right in zip(alone.robot_list, first.robot_list, strict=True):
        np.testing.assert_array_equal(left.state, right.state)


def test_a_robot_with_another_drive_may_join(scene: str) -> None:
    env = irsim.make(scene, display=False, policy="random", seed=3, log_level="ERROR")
    paths(env, 3)
    env.add_object(env.create_robot(kinematics={"name": "omni"}, state=[30, 30, 0], goal=[40, 40]))
    before = env.robot_list[-1].state.copy()
    paths(env, 3)
    assert not np.array_equal(before, env.robot_list[-1].state)


class OnlyDiff(Policy):
    name = "only-diff"
    drives = frozenset({"diff"})

    def act(self, observations: Observations) -> np.ndarray:
        return np.tile([0.1, 0.0], (len(observations), 1))


def test_a_robot_that_does_not_fit_is_refused_in_every_step(scene: str) -> None:
    env = irsim.make(scene, display=False, policy=OnlyDiff(), log_level="ERROR")
    env.add_object(env.create_robot(kinematics={"name": "omni"}, state=[30, 30, 0], goal=[40, 40]))
    for _ in range(2):
        with pytest.raises(PolicyError, match="omni"):
            env.step()
