"""Code of users: speeds and delays of objects written in Python are perturbed, and `--import` registers it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app
from irsim.env import Env
from irsim.env.batch import batch
from irsim.lib import KinematicsHandler, register_behavior, register_group_behavior, register_kinematics
from irsim.scenario.open import import_modules, read_scenario
from irsim.scenario.perturbation import perturbed, read_perturbations
from irsim.scenario.resolve.resolved import ResolvedScenario

SCENE = """
robot:
  - number: 2
    kinematics: {name: %s}
    shape: {name: circle, radius: 0.2}
    state: [[1, 1, 0], [1, 4, 0]]
    goal: [[9, 1], [9, 4]]
    vel_max: %s
    behavior: %s
    group_behavior: %s
"""


def scene(
    drive: str = "diff", behavior: str = "null", group: str = "null", top: str = "[1, 1]", perturb: str = "delay=4"
) -> ResolvedScenario:
    scenario, _ = read_scenario(text=SCENE % (drive, top, behavior, group), strict=False)
    return perturbed(scenario, read_perturbations(perturb))


def opened(scenario: ResolvedScenario, seed: int = 3) -> irsim.Env:
    return Env(scenario, seed=seed, headless=True, log_level="ERROR")


def assert_starts_late(env: irsim.Env) -> None:
    """Each robot stands until its time has come, and moves from then on."""
    starts = env.simulation.start_step.copy()
    assert len(set(starts.tolist())) == 2
    assert (starts > 0).all()
    for step in range(int(starts.max()) + 1):
        before = env.simulation.pose.copy()
        env.step()
        moved = (env.simulation.pose != before).any(axis=1)
        assert moved.tolist() == (step >= starts).tolist()


def register_slider(controls: int) -> None:
    """A drive in Python that moves along x with its first control."""

    @register_kinematics(f"slider{controls}")
    class Slider(KinematicsHandler):
        action_dim = controls
        vel_max = (1.0,) * controls
        vel_min = (-1.0,) * controls
        acce = (float("inf"),) * controls

        def step(self, state: Any, velocity: Any, step_time: float) -> Any:
            return state + np.array([[velocity[0, 0] * step_time], [0.0], [0.0]])


def test_behaviors_are_not_asked_before_the_start() -> None:
    asked: list[tuple[str, int]] = []

    @register_behavior("diff", "go_when_asked")
    def go(ego_object: Any, external_objects: Any, **_: Any) -> list[float]:
        asked.append((ego_object.name, int(ego_object._simulation.count[0])))
        return [0.5, 0.0]

    env = opened(scene(behavior="{name: go_when_asked}"))
    assert_starts_late(env)
    for name, start in zip(("robot_0", "robot_1"), env.simulation.start_step, strict=True):
        assert min(step for who, step in asked if who == name) == start


def test_members_of_groups_start_each_at_its_time() -> None:
    register_group_behavior("diff", "go_together")(lambda members, **_: [[0.5, 0.0]] * len(members))
    assert_starts_late(opened(scene(group="{name: go_together}")))
    assert_starts_late(opened(scene(group="{name: orca}")))


@pytest.mark.parametrize("controls", [2, 5])
def test_drives_in_python_stand_and_keep_to_their_changed_speed(controls: int) -> None:
    register_slider(controls)
    register_behavior(f"slider{controls}", "full_speed")(lambda **_: [9.0] * controls)
    top = str([2.0] * controls)
    assert_starts_late(opened(scene(f"slider{controls}", "{name: full_speed}", top=top)))
    env = opened(scene(f"slider{controls}", "{name: full_speed}", top=top, perturb="speed=0.5"))
    env.step()
    for robot, pace in zip(env.robot_list, env.simulation.pace, strict=True):
        assert pace != 1
        assert robot.velocity[:, 0].tolist() == [2.0 * pace] + [2.0] * (controls - 1)
        assert robot.vel_max[:, 0].tolist() == robot.velocity[:, 0].tolist()
        assert robot.state[0, 0] == pytest.approx(1 + 0.2 * pace)


def test_objects_with_steps_of_their_own_wait() -> None:
    env = opened(scene(behavior="{name: dash}"))
    called: list[int] = []
    for robot in env.robot_list:
        default = robot.step

        def step(*args: Any, default: Any = default, **kwargs: Any) -> Any:
            called.append(int(env.simulation.count[0]))
            return default(*args, **kwargs)

        robot.step = step
    assert_starts_late(env)
    assert min(called) == env.simulation.start_step.min()


def test_scripts_see_the_speed_of_the_scene() -> None:
    env = opened(scene("omni", "{name: dash}", top="[1, 2]", perturb="speed=0.4"))
    for robot, pace in zip(env.robot_list, env.simulation.pace, strict=True):
        assert robot.vel_max[:, 0].tolist() == [pace, 2 * pace]
        assert robot.max_speed == pytest.approx(pace * 5**0.5)
        assert robot.get_desired_omni_vel()[0, 0] == pytest.approx(pace)
    first = env.robot.max_speed
    env.reset(random=True)
    assert env.robot.max_speed != first


def test_speeds_and_delays_stay_when_other_objects_go() -> None:
    scenario = scene("omni", "{name: dash}", perturb="speed=0.4,delay=4")
    env, whole = opened(scenario), opened(scenario)
    env.delete_object(0)
    assert env.simulation.start_step.tolist() == whole.simulation.start_step[1:].tolist()
    for _ in range(60):
        env.step()
        whole.step()
    assert env.simulation.pose[0].tolist() == whole.simulation.pose[1].tolist()


def test_a_world_of_a_batch_is_that_world_alone() -> None:
    register_behavior("diff", "half_ahead")(lambda ego_object, **_: [ego_object.max_speed / 2, 0.0])
    scenario = scene(behavior="[{name: half_ahead}, {name: dash}]", perturb="position=0.2,speed=0.4,delay=2")
    many = batch(scenario, 3, seeds=[3, 4, 5])
    for _ in range(40):
        many.step()
    for world, seed in enumerate((3, 4, 5)):
        env = opened(scenario, seed)
        for _ in range(40):
            env.step()
        np.testing.assert_array_equal(many.pose[world], env.simulation.pose)


MODULE = '''
from irsim.lib import KinematicsHandler, register_behavior_class, register_kinematics


@register_kinematics("hover")
class Hover(KinematicsHandler):
    """Glides."""

    def step(self, state, velocity, step_time):
        moved = state.copy()
        moved[:2] += velocity * step_time
        return moved

    def velocity_from_xy(self, state, velocity_xy):
        return velocity_xy


@register_behavior_class("hover", "drift")
class Drift:
    def __init__(self, object_info, **keys):
        self.pace = keys["pace"]

    def __call__(self, ego_object, external_objects, **keys):
        return [self.pace, 0.0]
'''
SCENARIO = """
world: {time_limit: 4}
robot:
  - {kinematics: {name: hover}, shape: {name: circle, radius: 0.2}, state: [1, 1, 0], goal: [2, 1],
     behavior: {name: drift, pace: 0.5}}
  - {kinematics: {name: hover}, shape: {name: circle, radius: 0.2}, state: [1, 3, 0], goal: [2, 4],
     behavior: {name: dash}}
"""


def test_drives_and_behaviors_of_an_imported_module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "own_code.py").write_text(MODULE)
    (tmp_path / "scenario.yaml").write_text(SCENARIO)
    monkeypatch.chdir(tmp_path)
    imported = ("--import", "own_code")
    unknown, valid, done = (
        CliRunner().invoke(app, [verb, "scenario.yaml", *options])
        for verb, *options in (
            ("validate",),
            ("validate", *imported),
            ("run", "--strict", *imported, "--require-success", "--json"),
        )
    )
    del sys.modules["own_code"]
    assert (unknown.exit_code, valid.exit_code, done.exit_code) == (2, 0, 0), done.output
    assert "unknown-kinematics" in unknown.output


@pytest.mark.parametrize("name", ["modules_beside/own_place.py", "modules_beside.own_place"])
def test_modules_below_the_current_folder_are_found_by_any_start(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    (tmp_path / "modules_beside").mkdir()
    (tmp_path / "modules_beside" / "own_place.py").write_text("SEEN = True\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [path for path in sys.path if path])  # as the installed command starts
    try:
        import_modules([name])
        assert sys.modules["modules_beside.own_place"].SEEN
    finally:
        for module in ("modules_beside.own_place", "modules_beside"):
            sys.modules.pop(module, None)
