"""Behaviors of users: by function and class, alone and in groups, loaded before and after `make`."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.diagnostics.errors import BehaviorError, ScenarioError
from irsim.lib import register_behavior, register_behavior_class, register_group_behavior, register_group_behavior_class
from irsim.lib.behavior import behavior_registry

Make = Callable[..., irsim.Env]
TWO = """
robot:
  - number: 2
    kinematics: {name: %s}
    shape: {name: circle, radius: 0.2}
    state: [[1, 1, 0], [1, 4, 0]]
    goal: [[8, 1], [8, 4]]
    vel_max: [2, 2]
    behavior: %s
    group_behavior: %s
"""


def two(drive: str = "diff", behavior: str = "null", group: str = "null") -> str:
    return TWO % (drive, behavior, group)


def velocities(env: irsim.Env) -> list[list[float]]:
    return [robot.velocity[:, 0].tolist() for robot in env.robot_list]


def test_a_class_is_constructed_once_per_object_and_called_in_every_step(make: Make) -> None:
    made: list[tuple[str, dict[str, Any]]] = []

    @register_behavior_class("diff", "counting")
    class Counting:
        def __init__(self, object_info: Any, **behavior_dict: Any) -> None:
            made.append((object_info.name, behavior_dict))
            self.calls = 0

        def __call__(self, ego_object: Any, external_objects: list[Any], **behavior_dict: Any) -> Any:
            self.calls += 1
            assert [other.id for other in external_objects] == [1 - ego_object.id]
            assert behavior_dict == {"name": "counting", "gain": 2, "wander": False}
            return np.array([[0.1 * self.calls], [0.0]])

    env = make(two(behavior="{name: counting, gain: 2, wander: false}"))
    keys = {"name": "counting", "gain": 2, "wander": False}
    assert made == [("robot_0", keys), ("robot_1", keys)]
    env.step()
    env.step()
    assert velocities(env) == [[pytest.approx(0.2), 0.0]] * 2
    env.reset()
    env.step()
    assert velocities(env)[0][0] == pytest.approx(0.3), "reset keeps the instance"
    env.reset(random=True)
    env.step()
    assert len(made) == 4
    assert velocities(env)[0][0] == pytest.approx(0.1), "a new scene has new ones"


@pytest.mark.parametrize(("roles", "seen"), [("all", [1, 2]), ("robot", [1]), ("obstacle", [2])])
def test_target_roles_choose_what_it_sees(make: Make, roles: str, seen: list[int]) -> None:
    told: list[list[int]] = []

    @register_behavior("diff", "looking")
    def looking(ego_object: Any, external_objects: list[Any], **_: Any) -> Any:
        told.append([other.id for other in external_objects])
        return [0, 0]

    others = f"{{name: looking, target_roles: {roles}}}"
    make(two(behavior=others) + "obstacle: {shape: {name: circle, radius: 0.2}, state: [5, 8, 0]}").step()
    assert told[0] == seen


def test_a_class_wins_over_a_function_and_over_what_is_built_in(make: Make) -> None:
    register_behavior("diff", "both")(lambda **_: [0.1, 0.0])
    register_behavior_class("diff", "both")(lambda info, **_: lambda **_: [0.5, 0.0])
    register_behavior_class("diff", "dash")(lambda info, **_: lambda **_: [0.7, 0.0])
    env = make(two(behavior="[{name: both}, {name: dash, strength: 3}]"), strict=True)
    env.step()
    assert velocities(env) == [[0.5, 0.0], [0.7, 0.0]]


def test_a_constructor_that_fails_is_logged_and_left_out(make: Make, capsys: pytest.CaptureFixture[str]) -> None:
    def fails(object_info: Any, **_: Any) -> Any:
        raise RuntimeError("no battery")

    register_behavior_class("diff", "careful")(fails)
    register_behavior("diff", "careful")(lambda **_: [0.3, 0.0])
    env = make(two(behavior="{name: careful}"))
    assert "no battery" in capsys.readouterr().out
    env.step()
    assert velocities(env) == [[0.3, 0.0]] * 2


def test_a_behavior_of_the_same_name_for_a_drive_that_has_none_in_irsim(make: Make) -> None:
    register_behavior("acker", "rvo")(lambda **keys: [keys["pace"], 0.2])
    text = two("acker", "{name: rvo, pace: 0.4}").replace("0], [1, 4, 0]", "0, 0], [1, 4, 0, 0]")
    env = make(text, strict=True)
    env.step()
    assert velocities(env) == [[0.4, 0.2]] * 2


@pytest.mark.parametrize("drive", ["diff", "omni"])
@pytest.mark.parametrize("name", ["dash", "rvo", "sfm"])
def test_what_is_built_in_cannot_be_registered_as_a_function(drive: str, name: str) -> None:
    with pytest.raises(ValueError, match="built-in"):
        register_behavior(drive, name)(print)


def test_a_pair_is_registered_once() -> None:
    for register in (
        register_behavior,
        register_behavior_class,
        register_group_behavior,
        register_group_behavior_class,
    ):
        register("diff", "mine")(print)
        register("omni", "mine")(len)
        with pytest.raises(ValueError, match="already registered"):
            register("diff", "mine")(len)
    assert behavior_registry.behaviors_map["diff", "mine"] is print
    assert behavior_registry.group_behaviors_class_map["omni", "mine"] is len
    with pytest.raises(ValueError, match="built-in"):
        register_group_behavior_class("omni", "orca")(print)


def test_group_functions_fill_what_nobody_commands(make: Make) -> None:
    @register_group_behavior("diff", "convoy")
    def convoy(members: list[Any], name: str, pace: float) -> list[Any]:
        assert [member.name for member in members] == ["robot_0", "robot_1"]
        assert name == "convoy"
        return [np.array([[pace], [0.0]]), None]

    register_behavior("diff", "own")(lambda **_: [0.2, 0.0])
    env = make(two(behavior="{name: own}", group="{name: convoy, pace: 0.6}"), strict=True)
    env.step()
    assert velocities(env) == [[0.6, 0.0], [0.2, 0.0]]
    env.step([0.9, 0.1])
    assert velocities(env) == [[0.9, 0.1], [0.2, 0.0]], "an action beats the group"


def test_group_members_fall_back_to_a_built_in_behavior(make: Make) -> None:
    register_group_behavior("diff", "shy")(lambda members, **_: [None for _ in members])
    env, plain = make(two(behavior="{name: dash}", group="{name: shy}")), make(two(behavior="{name: dash}"))
    for each in (env, plain):
        each.step()
    assert velocities(env) == velocities(plain)
    assert velocities(env)[0][0] > 0


def test_group_classes_are_constructed_once(make: Make) -> None:
    made = []

    @register_group_behavior_class("omni", "swarm")
    class Swarm:
        def __init__(self, members: list[Any], **options: Any) -> None:
            made.append((len(members), options))
            self.calls = 0

        def __call__(self, members: list[Any], **options: Any) -> list[Any]:
            self.calls += 1
            return [[0.1 * self.calls, 0.0] for _ in members]

    env = make(two("omni", group="{name: swarm, k: 1}"), strict=True)
    env.step()
    env.step()
    assert made == [(2, {"name": "swarm", "k": 1})]
    assert velocities(env) == [[0.2, 0.0]] * 2


def test_an_unknown_group_behavior_leaves_members_to_their_own(make: Make, capsys: pytest.CaptureFixture[str]) -> None:
    env = make(two(behavior="{name: dash}", group="{name: nobody_knows}"))
    env.step()
    env.step()
    assert velocities(env)[0][0] == pytest.approx(2.0)
    assert capsys.readouterr().out.count("nobody_knows") == 1
    with pytest.raises(ScenarioError, match="nobody_knows"):
        make(two(behavior="{name: dash}", group="{name: nobody_knows}"), strict=True)


def test_a_function_without_keyword_catch_all_gets_the_keys_of_the_file_and_no_more(make: Make) -> None:
    def cruise(ego_object: Any, external_objects: list[Any], name: str, speed: float, target_roles: str) -> Any:
        assert name == "cruise"
        assert [other.name for other in external_objects] == ["obstacle_2"]
        return np.array([[speed], [0.1]])

    register_behavior("diff", "cruise")(cruise)
    others = "obstacle: {shape: {name: circle, radius: 0.2}, state: [5, 8, 0]}"
    env = make(two(behavior="{name: cruise, speed: 0.4, target_roles: obstacle}") + others)
    env.step()
    assert env.robot.state.ravel().tolist() == pytest.approx([1.04, 1.0, 0.01])


def test_everybody_sees_the_same_snapshot(make: Make) -> None:
    seen = []

    @register_behavior("omni", "spy")
    def spy(ego_object: Any, external_objects: list[Any], **_: Any) -> list[float]:
        seen.append([float(other.state[0, 0]) for other in external_objects])
        return [1.0, 0.0]

    env = make(two("omni", "{name: spy}"))
    env.step()
    env.step()
    assert seen == [[1.0], [1.0], [pytest.approx(1.1)], [pytest.approx(1.1)]]


def test_what_a_behavior_returns_is_limited_like_any_control(make: Make) -> None:
    register_behavior("diff", "wild")(lambda **_: [99.0, -99.0])
    env = make(two(behavior="{name: wild}"))
    env.step()
    assert velocities(env) == [[2.0, -1.0]] * 2


def test_load_behavior_finds_modules_beside_the_script_and_constructs_anew(
    make: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "loaded_late.py").write_text(
        "from irsim.lib import register_behavior_class\n"
        "made = []\n"
        "@register_behavior_class('diff', 'late')\n"
        "class Late:\n"
        "    def __init__(self, info, **_):\n"
        "        made.append(info.name)\n"
        "    def __call__(self, ego_object, external_objects, **_):\n"
        "        return [0.3, 0.0]\n"
    )
    monkeypatch.setattr(sys, "argv", [str(tmp_path / "run.py")])
    monkeypatch.setattr(sys, "path", list(sys.path))
    env = make(two(behavior="{name: late}"))
    with pytest.raises(ScenarioError, match="late"):
        env.step()
    env.load_behavior("loaded_late")
    env.step()
    assert velocities(env) == [[0.3, 0.0]] * 2
    made = sys.modules["loaded_late"].made
    assert made == ["robot_0", "robot_1"]
    env.load_behavior("loaded_late")
    assert len(made) == 4
    env.load_behavior("no_such_module_anywhere")
    assert "no_such_module_anywhere" in capsys.readouterr().out
    del sys.modules["loaded_late"]


def test_in_a_batch_each_world_is_the_one_alone(make: Make, tmp_path: Path) -> None:
    @register_behavior_class("diff", "drawn")
    class Drawn:
        def __init__(self, info: Any, **_: Any) -> None:
            self.turn = 0.0

        def __call__(self, ego_object: Any, external_objects: list[Any], **_: Any) -> Any:
            self.turn += 0.1
            return [0.5, self.turn * float(ego_object.state[1, 0] > 2)]

    text = two(behavior="{name: drawn}").replace("name: diff", "name: diff, noise: true")
    alone = make(text, seed=5)
    batch = irsim.batch(tmp_path / "scenario.yaml", 2, seeds=[5, 6])
    for _ in range(4):
        alone.step()
        batch.step()
    assert (batch.pose[0] == alone.simulation.pose).all()
    assert (batch.pose[1] != alone.simulation.pose).any()


@pytest.mark.parametrize("returned", [None, [1.0], [1.0, float("nan")], "ahead"])
def test_what_is_no_control_is_said_so(make: Make, returned: Any) -> None:
    register_behavior("diff", "odd")(lambda **_: returned)
    env = make(two(behavior="{name: odd}"))
    with pytest.raises(BehaviorError, match="odd"):
        env.step()
