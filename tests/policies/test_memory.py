"""A network from a file drives worlds, the same in each use; what it remembers belongs to a robot of a simulation."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import irsim
from irsim.diagnostics.errors import PolicyError
from irsim.policies import Observations, Policy
from irsim.policies.networks import save_network
from tests.policies.networks.examples import crowd, filled, go_to_goal

SCENE = """
world: {width: 10, height: 10, time_limit: 25}
robot:
  - number: 2
    kinematics: {name: diff}
    distribution: {name: random, range_low: [1, 1, -3], range_high: [9, 9, 3]}
    behavior: {name: dash}
"""


@pytest.fixture(autouse=True)
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("scene.yaml").write_text(SCENE)
    save_network("net.npz", go_to_goal())


def test_a_batch_equals_single_environments() -> None:
    batch = irsim.batch("scene.yaml", 3, seeds=[4, 5, 6], policy="net.npz")
    batch.advance(60)
    for world, seed in enumerate((4, 5, 6)):
        env = irsim.make("scene.yaml", headless=True, seed=seed, log_level="ERROR", policy="net.npz")
        for _ in range(60):
            env.step()
        assert batch.pose[world].tobytes() == env.simulation.pose.tobytes()


def test_it_reaches_its_goals_in_a_benchmark_whatever_the_number_of_processes() -> None:
    one = irsim.benchmark("scene.yaml", ["net.npz", "random"], 4, workers=1)
    assert one.rows[0].success.count + one.rows[0].collision.count == 4
    assert one == irsim.benchmark("scene.yaml", ["net.npz", "random"], 4, workers=2)


def test_it_is_described() -> None:
    from irsim.policies.description import describe_policy

    description = describe_policy("net.npz")
    assert (description.kind, description.drives, description.output) == ("file", ["diff"], "control")
    assert description.digest == irsim.open_policy("net.npz").digest


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
