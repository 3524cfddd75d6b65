"""The plug-in for NeuPAN, with a stand-in for its package, which is on no registry."""

from __future__ import annotations

import importlib.util
import math
import sys
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import yaml

import irsim
from irsim.diagnostics.errors import ArgumentError, PolicyError
from irsim.policies import open_policy
from irsim.policies.description import describe_policy

ROBOT = {"name": "rectangle", "length": 0.6, "width": 0.4}
SCENE: dict[str, Any] = {
    "world": {"width": 10, "height": 10, "step_time": 0.1, "time_limit": 20},
    "robot": [
        {
            "kinematics": {"name": "diff"}, "shape": ROBOT, "state": [1, 5, 0.3], "goal": [5, 5], "goal_threshold": 0.3,
            "vel_max": [1, 2], "vel_min": [-1, -2],
            "sensors": [
                {"name": "lidar2d", "number": 90, "range_max": 4, "angle_range": 6.28, "offset": [0.2, 0.1, 0.5]}
            ],
        }
    ],
    "obstacle": [
        {"shape": {"name": "circle", "radius": 0.5}, "state": [3, 7, 0]},
        {"kinematics": {"name": "omni"}, "shape": {"name": "circle", "radius": 0.4}, "state": [2, 3, 0], "goal": [9, 3],
         "behavior": {"name": "dash"}, "vel_max": [0.5, 0.5]},
    ],
}  # fmt: skip


class StandIn:
    """Stand-in for the class ``neupan`` of the package: drives straight to the goal and keeps what it was given."""

    made: list[StandIn]

    def __init__(self, **config: Any) -> None:
        self.config, self.seen, self.goal, self.resets = config, [], None, 0
        self.made.append(self)
        print("a planner is made")
        if config["pan_kwargs"]["dune_checkpoint"].endswith("broken.pth"):
            input("train it now? ")

    def reset(self) -> None:
        self.resets += 1

    def update_initial_path_from_goal(self, start: np.ndarray, goal: np.ndarray) -> None:
        assert start.shape == goal.shape == (3, 1)
        self.goal = goal[:, 0]

    def __call__(self, state: np.ndarray, points: Any, velocities: Any) -> tuple[np.ndarray, dict[str, Any]]:
        assert state.shape == (3, 1)
        self.seen.append((state[:, 0], points, velocities))
        print("a decision took 3 ms")
        if waypoints := self.config["ipath_kwargs"].get("waypoints"):
            self.goal = np.array(waypoints[-1])
        if np.hypot(*(self.goal[:2] - state[:2, 0])) < self.config.get("stop_within", 0.1):
            return np.zeros((2, 1)), {"arrive": self.config.get("stop_within") is None, "stop": True}
        away = self.goal[:2] - state[:2, 0]
        if self.config["robot_kwargs"]["kinematics"] == "omni":
            return away[:, None], {}
        turn = math.remainder(math.atan2(away[1], away[0]) - state[2, 0], math.tau)
        return np.array([[self.config["ref_speed"] * max(0.0, math.cos(turn))], [2 * turn]]), {}


@pytest.fixture
def package(monkeypatch: pytest.MonkeyPatch) -> list[StandIn]:
    """The stand-in as the installed package; the planners that it makes."""
    made: list[StandIn] = []
    module = ModuleType("neupan")
    module.__spec__ = ModuleSpec("neupan", None)
    module.neupan = type("neupan", (StandIn,), {"made": made})  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "neupan", module)
    return made


def config(folder: Path, rest: dict[str, Any] | None = None, **robot: Any) -> str:
    """A file of NeuPAN, and the network that it names."""
    (folder / "model.pth").touch()
    data: dict[str, Any] = {
        "receding": 10, "ref_speed": 0.8, "robot": {"kinematics": "diff", **robot}, "ipath": {"curve_style": "line"},
        "pan": {"dune_checkpoint": "model.pth"}, "adjust": {"q_s": 0.1},
    }  # fmt: skip
    data.update(rest or {})
    file = folder / "planner.yaml"
    file.write_text(yaml.safe_dump(data))
    return str(file)


def planner(folder: Path, options: dict[str, Any] | None = None, **robot: Any) -> Any:
    """The policy with such a file."""
    return open_policy({"name": "neupan", "config": config(folder, **robot), **(options or {})})


def scene(folder: Path, **robot: Any) -> Path:
    file = folder / "scene.yaml"
    file.write_text(yaml.safe_dump({**SCENE, "robot": [{**SCENE["robot"][0], **robot}]}))
    return file


def test_each_robot_has_a_planner_with_its_footprint_and_arrives(package: list[StandIn], tmp_path: Path) -> None:
    policy = planner(tmp_path)
    result = irsim.run(scene(tmp_path, number=2, state=[[1, 5, 0.3], [1, 8, 0]], goal=[[5, 5], [5, 8]]), policy=policy)
    assert result.outcome == "success"
    assert len(package) == 2
    given = package[0].config
    assert sorted(given["robot_kwargs"]["vertices"]) == [[x, y] for x in (-0.3, 0.3) for y in (-0.2, 0.2)]
    assert (given["step_time"], given["ref_speed"]) == (pytest.approx(0.1), 0.8)
    assert given["ipath_kwargs"] == {"curve_style": "line", "arrive_threshold": 0.3}
    assert given["pan_kwargs"]["dune_checkpoint"] == str(tmp_path / "model.pth")
    assert given["adjust_kwargs"] == {"q_s": 0.1}
    np.testing.assert_allclose(package[1].goal, [5, 8, 0])


def test_points_lie_on_what_the_lidar_sees_and_move_with_it(package: list[StandIn], tmp_path: Path) -> None:
    policy = planner(tmp_path, {"velocities": True})
    irsim.run(scene(tmp_path), policy=policy, steps=5)
    _, points, velocities = package[0].seen[3]
    assert points.shape == velocities.shape
    assert points.shape[1] > 5
    post = np.abs(np.hypot(points[0] - 3, points[1] - 7) - 0.5) < 0.02
    walker = ~post
    assert min(post.sum(), walker.sum()) >= 3
    assert np.hypot(points[0, walker] - 2.15, points[1, walker] - 3).max() < 0.45  # it has moved for 3 steps
    np.testing.assert_allclose(velocities[:, post], 0.0)
    np.testing.assert_allclose(velocities[:, walker].T, np.tile([0.5, 0.0], (walker.sum(), 1)), atol=1e-9)
    irsim.run(scene(tmp_path), policy=planner(tmp_path), steps=2)
    assert package[1].seen[0][2] is None


def test_nothing_in_sight(package: list[StandIn], tmp_path: Path) -> None:
    sensors = [{**SCENE["robot"][0]["sensors"][0], "range_max": 0.5}]
    irsim.run(scene(tmp_path, sensors=sensors), policy=planner(tmp_path), steps=2)
    assert package[0].seen[0][1] is None


def test_an_omni_robot_follows_velocities_of_the_world(package: list[StandIn], tmp_path: Path) -> None:
    policy = planner(tmp_path, kinematics="omni")
    assert policy.output == "velocity"
    result = irsim.run(scene(tmp_path, kinematics={"name": "omni"}, state=[1, 5, 1.2]), policy=policy)
    assert result.outcome == "success"


def test_a_new_episode_resets_the_planner_and_the_path(package: list[StandIn], tmp_path: Path) -> None:
    policy = planner(tmp_path, {"speed": 0.5})
    env = irsim.make(scene(tmp_path), policy=policy, headless=True)
    for _ in range(3):
        env.step()
    package[0].goal = None
    env.reset()
    env.step()
    assert len(package) == 1
    assert (package[0].resets, package[0].goal is None, package[0].config["ref_speed"]) == (1, False, 0.5)
    env.end(ending_time=0)


def test_a_robot_with_another_footprint_than_the_network_is_refused(package: list[StandIn], tmp_path: Path) -> None:
    same = planner(tmp_path, length=0.6, width=0.4)
    assert irsim.run(scene(tmp_path), policy=same, steps=2).steps == 2
    other = planner(tmp_path, length=1.6, width=2.0)
    with pytest.raises(PolicyError, match="policy-mismatch") as raised:
        irsim.run(scene(tmp_path), policy=other, steps=2)
    assert "trained for a robot with the corners [[-0.8, -1.0]" in raised.value.message
    car = planner(tmp_path, kinematics="acker", length=4.6, width=1.6, wheelbase=3)
    shape = {"name": "rectangle", "length": 4.6, "width": 1.6, "wheelbase": 3}
    driven = scene(tmp_path, kinematics={"name": "acker", "wheelbase": 3}, shape=shape, state=[3, 5, 0], goal=[8, 5])
    assert irsim.run(driven, policy=car, steps=2).steps == 2
    with pytest.raises(PolicyError, match="controls acker"):
        irsim.run(scene(tmp_path), policy=car)


@pytest.mark.parametrize(
    ("options", "error", "why"),
    [
        ({"config": "no-such.yaml"}, PolicyError, "cannot be read"),
        ({"config": 5}, PolicyError, "cannot be read"),
        ({"velocities": 1}, ArgumentError, "velocities must be true or false"),
        ({"speed": 0}, ArgumentError, "speed must be above 0"),
        ({"sped": 1}, PolicyError, "has no option 'sped'"),
    ],
)
def test_options_that_cannot_be_used(
    options: dict[str, Any], error: type[Exception], why: str, package: list[StandIn], tmp_path: Path
) -> None:
    with pytest.raises(error, match=why):
        planner(tmp_path, options)
    with pytest.raises(PolicyError, match="has the kinematics 'legged'"):
        planner(tmp_path, kinematics="legged")


def test_the_path_of_the_file_is_driven_and_its_end_is_told(package: list[StandIn], tmp_path: Path) -> None:
    path = {"waypoints": [[1, 5, 0], [2, 6, 0.5], [3, 5.2, 0]], "loop": False}
    policy = open_policy({"name": "neupan", "config": config(tmp_path, {"ipath": path})})
    result = irsim.run(scene(tmp_path, state=[1, 5, 0], goal=[9, 9]), policy=policy, steps=80)
    assert package[0].config["ipath_kwargs"] == {**path, "arrive_threshold": 0.3}
    assert result.outcome == "timeout"
    assert str(result.reason).endswith("from its goal: NeuPAN has arrived at [3.0, 5.2], where its path ends")
    env = irsim.make(scene(tmp_path, goal=[9, 9]), policy=policy, headless=True)
    env.step()
    env.reset()
    env.step()
    assert len(package) == 3  # the path of each episode begins where the robot is
    env.end(ending_time=0)


def test_a_stop_is_in_the_reason(package: list[StandIn], tmp_path: Path) -> None:
    file = config(tmp_path, {"stop_within": 3.0, "collision_threshold": 0.2})
    result = irsim.run(scene(tmp_path), policy=open_policy({"name": "neupan", "config": file}), steps=40)
    assert "from its goal: NeuPAN stops because something is nearer than collision_threshold (0.2 m)" in str(
        result.reason
    )


def test_nothing_is_printed_or_asked(
    package: list[StandIn], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    irsim.run(scene(tmp_path), policy=planner(tmp_path), steps=3)
    assert capsys.readouterr().out == ""
    (tmp_path / "broken.pth").touch()
    file = config(tmp_path, {"pan": {"dune_checkpoint": "broken.pth"}})
    with pytest.raises(PolicyError, match="asks a question about the network"):
        irsim.run(scene(tmp_path), policy=open_policy({"name": "neupan", "config": file}), steps=3)


@pytest.mark.parametrize(
    ("rest", "why"),
    [
        ({"pan": {"dune_checkpoint": "gone.pth"}}, "names the network 'gone.pth', which is in none of /"),
        ({"pan": {"dune_checkpoint": "None"}}, "names no network"),
        ({"pan": None}, "names no network"),
        ({"robot": [5]}, "section robot is not a mapping"),
        ({"ipath": {"waypoints": [[1, 2]]}}, "waypoints is a list of poses"),
        ({"ipath": {"waypoints": [[1, 2, "x"], [3]]}}, "waypoints is a list of poses"),
    ],
)
def test_a_file_without_its_network_is_refused_before_the_run(
    rest: dict[str, Any], why: str, package: list[StandIn], tmp_path: Path
) -> None:
    with pytest.raises(PolicyError, match=why):
        open_policy({"name": "neupan", "config": config(tmp_path, rest)})


def test_a_network_is_found_above_the_file(package: list[StandIn], tmp_path: Path) -> None:
    folder = tmp_path / "example" / "corridor" / "diff"
    folder.mkdir(parents=True)
    (tmp_path / "example" / "deep.pth").touch()
    file = config(folder, {"pan": {"dune_checkpoint": "example/deep.pth"}})
    irsim.run(scene(tmp_path), policy=open_policy({"name": "neupan", "config": file}), steps=1)
    assert package[0].config["pan_kwargs"]["dune_checkpoint"] == str(tmp_path / "example" / "deep.pth")


@pytest.mark.skipif(importlib.util.find_spec("neupan") is not None, reason="NeuPAN is installed")
def test_without_the_package_the_command_that_installs_it_is_told(tmp_path: Path) -> None:
    with pytest.raises(PolicyError, match="missing-extra: the policy 'neupan' needs the package neupan") as raised:
        planner(tmp_path)
    assert "git clone https://github.com/hanruihua/NeuPAN" in str(raised.value.fix)
    assert "neupan" in irsim.policies.registry.POLICIES.names()
    with pytest.raises(PolicyError, match="needs the package neupan"):
        open_policy("neupan")
    info = describe_policy("neupan")
    assert info.needs == ["a lidar", "the package neupan"]
    assert "git clone" in str(info.install)
    assert info.meanings["config"].startswith("The YAML file of NeuPAN")


def test_a_missing_option_is_named(package: list[StandIn]) -> None:
    with pytest.raises(PolicyError, match="policy 'neupan' needs the option config") as raised:
        open_policy("neupan")
    assert str(raised.value.fix).startswith("write {name: neupan, config: …}")
