"""One policy in an environment, a batch, a benchmark and a recorded run; its memory belongs to a robot."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.diagnostics.errors import PolicyError
from irsim.policies.description import describe_policy
from irsim.policies.driver import drivers_of
from irsim.policies.networks import save_network
from irsim.runs.reading import open_run
from irsim.runs.resimulation import resimulate
from tests.policies.networks.examples import crowd, filled, go_to_goal

TWO = """
world: {width: 10, height: 10, time_limit: 4}
robot:
  - {name: a, kinematics: {name: omni}, state: [1, 1, 0], goal: [3, 1], behavior: {name: dash}}
  - {name: b, kinematics: {name: omni}, state: [1, 5, 0], goal: [3, 5], behavior: {name: dash}}
"""


@pytest.fixture
def scene(tmp_path: Path) -> str:
    path = tmp_path / "two.yaml"
    path.write_text(TWO)
    return str(path)


def upward(observations: irsim.policies.Observations) -> Any:
    return np.tile([0.0, 0.5], (len(observations), 1))


def make(scene: str, **keys: Any) -> irsim.Env:
    return irsim.make(scene, headless=True, log_level="ERROR", **keys)


def test_functions_drive_an_environment(scene: str) -> None:
    env = make(scene, policy=upward)
    env.step()
    np.testing.assert_allclose(env.simulation.pose[:, :2], [[1, 1.05], [1, 5.05]])
    env.step([1.0, 0.0])  # an action takes precedence
    np.testing.assert_allclose(env.simulation.pose[:, :2], [[1.1, 1.05], [1, 5.1]])
    for begin_again in (env.reset, env.reload):
        begin_again()
        env.step()
        np.testing.assert_allclose(env.simulation.pose[:, :2], [[1, 1.05], [1, 5.05]])


def test_policies_are_changed_while_an_environment_runs(scene: str) -> None:
    env = make(scene)
    env.step()
    env.set_policy(upward)
    env.step()
    np.testing.assert_allclose(env.simulation.pose[0, :2], [1.1, 1.05])
    env.set_policy("sfm")
    assert not env.simulation.in_python
    assert [robot.beh_config["name"] for robot in env.robot_list] == ["sfm", "sfm"]
    env.step()
    env.set_policy({"name": "dash", "angle_tolerance": 0.2})
    assert env.robot.beh_config == {"name": "dash", "angle_tolerance": 0.2}
    env.set_policy(None)
    assert [robot.beh_config for robot in env.robot_list] == [{"name": "dash"}] * 2
    assert env.simulation.count[0] == 3


def test_a_behavior_given_to_make_equals_the_same_in_the_file(scene: str) -> None:
    env, other = make(scene, policy="{name: sfm, vmax: 0.7}"), Path(scene).with_name("sfm.yaml")
    other.write_text(TWO.replace("{name: dash}", "{name: sfm, vmax: 0.7}"))
    same = make(str(other))
    for made in (env, same):
        for _ in range(20):
            made.step()
    assert env.simulation.pose.tobytes() == same.simulation.pose.tobytes()
    env.set_policy(None)
    assert env.robot.beh_config == {"name": "dash"}


def test_robots_that_come_and_go_are_driven(scene: str) -> None:
    for policy in (upward, "sfm"):
        env = make(scene, policy=policy)
        env.step()
        new = {"name": "c", "state": [5, 5, 0], "goal": [8, 5, 0], "behavior": {"name": "dash"}}
        env.add_object(env.create_robot({"name": "omni"}, **new))
        env.delete_object("a")
        before = env.simulation.pose.copy()
        env.step()
        assert env.names == ["b", "c"]
        if policy == "sfm":
            assert [robot.beh_config["name"] for robot in env.robot_list] == ["sfm", "sfm"]
        else:
            np.testing.assert_allclose(env.simulation.pose[:, 1] - before[:, 1], 0.05)
        env.reset(random=True)
        assert env.names == ["a", "b"]
        env.step()
        assert (env.robot.beh_config["name"] == "sfm") is (policy == "sfm")


def test_a_policy_that_does_not_fit_changes_nothing(scene: str) -> None:
    env = make(scene)
    diff = irsim.policies.FunctionPolicy(upward, drives=frozenset({"diff"}))
    with pytest.raises(PolicyError, match="policy-mismatch"):
        env.set_policy(diff)
    env.step()
    np.testing.assert_allclose(env.simulation.pose[:, 0], 1.1)
    with pytest.raises(PolicyError, match="policy-mismatch"):
        make(scene, policy=diff)


def test_the_same_object_drives_a_batch(scene: str) -> None:
    env, batch = make(scene, policy="random", seed=4), irsim.batch(scene, 2, seeds=[3, 4], policy="random")
    for _ in range(10):
        env.step()
        batch.step()
    assert batch.pose[1].tobytes() == env.simulation.pose.tobytes()
    sfm = irsim.batch(scene, 2, policy="sfm")
    assert not sfm.simulation.in_python
    assert len(drivers_of(batch.simulation)) == 1


def test_a_batch_with_a_policy_runs_until_all_worlds_are_done(scene: str) -> None:
    def to_goal(observations: irsim.policies.Observations) -> Any:
        return (observations.goal - observations.pose)[:, :2]

    batch = irsim.batch(scene, 2, policy=to_goal)
    assert batch.advance(500, until_done=True) < 100
    assert batch.done.all()


def test_runs_know_their_policy_and_are_read_without_it(scene: str, tmp_path: Path) -> None:
    result = irsim.run(scene, policy="random", steps=20, seed=2, record=tmp_path / "run")
    assert (result.behavior, result.policy, result.policy_digest) == (None, "random", None)
    assert "--policy random" in result.reproduce
    assert irsim.run(scene, policy="random", steps=20, seed=2).robots == result.robots
    run = open_run(str(tmp_path / "run"))
    assert run.options["policy"] == "random"
    env = resimulate(run, 20)
    assert env.simulation.pose.tobytes() == run.trace().pose[20].tobytes()
    env.end(ending_time=0.0)


def test_runs_with_functions_are_recorded_under_their_name(scene: str, tmp_path: Path) -> None:
    result = irsim.run(scene, policy=upward, steps=5, record=tmp_path / "run")
    assert result.policy == "upward"
    assert result.robots[0].pose[1] == pytest.approx(1.25)


def test_policy_and_behavior_are_one_argument(scene: str) -> None:
    assert irsim.run(scene, policy="sfm").behavior == "sfm"
    assert irsim.run(scene, policy="as-written").behavior is None
    with pytest.raises(ValueError, match="two names of one argument"):
        irsim.run(scene, policy="sfm", behavior="dash")


CROWD = """
world: {width: 10, height: 10, time_limit: 25}
robot:
  - number: 2
    kinematics: {name: diff}
    distribution: {name: random, range_low: [1, 1, -3], range_high: [9, 9, 3]}
    behavior: {name: dash}
"""
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
def network(tmp_path: Path) -> str:
    """A file whose network remembers."""
    data = crowd()
    data["layout"]["parts"][2]["range"] = 2.0
    save_network(tmp_path / "net.npz", filled(data))
    return str(tmp_path / "net.npz")


@pytest.fixture
def far(tmp_path: Path) -> str:
    (tmp_path / "far.yaml").write_text(FAR)
    return str(tmp_path / "far.yaml")


def drive(*envs: irsim.Env, steps: int) -> None:
    """Step environments in turns."""
    for _ in range(steps):
        for env in envs:
            env.step()


def test_a_network_reaches_its_goals_in_a_benchmark_and_is_described(tmp_path: Path) -> None:
    file = str(tmp_path / "net.npz")
    save_network(file, go_to_goal())
    one, two = (irsim.benchmark(CROWD, [file, "random"], 4, workers=workers) for workers in (1, 2))
    assert one.rows[0].success.count + one.rows[0].collision.count == 4
    assert one == two
    description = describe_policy(file)
    assert (description.kind, description.drives, description.output) == ("file", ["diff"], "control")
    assert description.digest == irsim.open_policy(file).digest


def test_a_removed_robot_takes_its_memory_with_it(far: str, network: str) -> None:
    with_all, without = (make(far, policy=network) for _ in range(2))
    drive(with_all, without, steps=10)
    without.delete_object("b")
    drive(with_all, without, steps=10)
    kept = [robot for robot in with_all.robot_list if robot.name != "b"]
    for left, right in zip(kept, without.robot_list, strict=True):
        np.testing.assert_array_equal(left.state, right.state)


def test_one_policy_drives_two_simulations_in_turns(far: str, network: str) -> None:
    alone = make(far, policy=network)
    drive(alone, steps=20)
    shared = irsim.open_policy(network)
    first, second = (make(far, policy=shared) for _ in range(2))
    drive(second, steps=3)
    drive(first, second, steps=20)
    for left, right in zip(alone.robot_list, first.robot_list, strict=True):
        np.testing.assert_array_equal(left.state, right.state)


def test_a_robot_with_another_drive_may_join_if_it_fits(far: str) -> None:
    ahead = irsim.policies.FunctionPolicy(upward, drives=frozenset({"diff"}))
    env, only_diff = make(far, policy="random", seed=3), make(far, policy=ahead)
    for one in (env, only_diff):
        drive(one, steps=3)
        one.add_object(one.create_robot(kinematics={"name": "omni"}, state=[30, 30, 0], goal=[40, 40]))
    before = env.robot_list[-1].state.copy()
    drive(env, steps=3)
    assert not np.array_equal(before, env.robot_list[-1].state)
    for _ in range(2):
        with pytest.raises(PolicyError, match="omni"):
            only_diff.step()
