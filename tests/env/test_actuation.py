"""Actuators of robots in environments: every drive and behavior, records, audits, replays, programs, contacts."""

from __future__ import annotations

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.lib import KinematicsHandler, register_kinematics
from irsim.options.registry import BEHAVIORS
from irsim.runs.audit.audit import audit_runs
from irsim.runs.reading import open_run
from irsim.testing import conformance

WHOLE = "{command_period: 0.2, delay: 0.15, resolution: 0.01, jerk: 20, lag: 0.1, dead_band: 0.02, noise: 0.01}"
ROBOT = """\
world: {width: 20, height: 10, step_time: 0.1, collision_mode: MODE, time_limit: 30}
robot:
  - {name: one, kinematics: {name: DRIVE}, shape: {name: circle, radius: 0.2}, state: [2, 5, 0], goal: [16, 5],
     goal_threshold: 0.5, vel_max: LIMIT, vel_min: -LIMIT, acce: RATES, behavior: {name: dash}, actuation: ACTUATION}
"""


def text(actuation: str = "null", drive: str = "diff", mode: str = "stop") -> str:
    """The scenario of one robot."""
    size = 3 if drive == "omni_angular" else 2
    limit, rates = [1.0] * size, [3.0] * size
    out = ROBOT.replace("-LIMIT", str([-v for v in limit])).replace("LIMIT", str(limit)).replace("RATES", str(rates))
    return out.replace("DRIVE", drive).replace("MODE", mode).replace("ACTUATION", actuation)


def test_programs_see_the_executed_velocity_and_not_the_command(make: Callable[..., Any]) -> None:
    env = make(text("{delay: 0.2}").replace("behavior: {name: dash}", "behavior: null").replace("[3.0, 3.0]", "null"))
    seen = []
    for _ in range(4):
        env.step([0.7, 0.1])
        seen.append(env.robot.velocity[:, 0].tolist())
    assert seen == [[0, 0], [0, 0], [0.7, 0.1], [0.7, 0.1]]
    env.robot.set_velocity([0.3, 0.0])
    env.step([0.0, 0.0])
    assert env.robot.velocity[0, 0] == 0.3, "a velocity that a program sets lasts through the dead time"
    env.reset()
    env.step([0.7, 0.1])
    assert not env.robot.velocity.any()
    env.end()


@pytest.mark.parametrize("drive", conformance.simulated_drives())
@pytest.mark.parametrize("behavior", [f.name for f in BEHAVIORS.features() if f.simulated and f.name != "replay"])
def test_every_behavior_drives_every_drive_through_actuators(drive: str, behavior: str) -> None:
    given = {"drive": drive, "behavior": f"{{name: {behavior}}}", "actuation": WHOLE}
    conformance.check_same_seed(**given)
    conformance.check_finite(**given)
    _, plain = conformance.simulate(conformance.scenario_with(drive=drive, behavior=f"{{name: {behavior}}}"))
    _, poses = conformance.simulate(conformance.scenario_with(**given))
    assert (abs(poses[:, :3, :2] - poses[0, :3, :2]).max(axis=(0, 2)) > 0.2).all(), "it moves the object"
    assert abs(poses[-1, :3, :2] - plain[-1, :3, :2]).max() > 0.02, "and not as without actuators"


@pytest.mark.parametrize("drive", ["diff", "omni", "omni_angular", "acker"])
@pytest.mark.parametrize("mode", ["stop", "contact"])
def test_a_recorded_run_agrees_with_its_audit(workspace: Path, drive: str, mode: str) -> None:
    result = irsim.run(text=text(WHOLE, drive, mode), seed=3, record="kept")
    assert result.outcome == "success", result.reason
    audit = audit_runs(["kept"]).runs[0]
    assert not audit.findings
    assert not audit.problems
    checked = {part.name: part for part in audit.checks}
    if mode == "stop":
        assert checked["motion"].compared > 100
        assert "has noise in its actuation" in checked["limits"].note


def test_the_limits_of_lagged_controls_are_audited(workspace: Path) -> None:
    irsim.run(text=text("{delay: 0.2, jerk: 9, lag: 0.2, dead_band: 0.4}"), seed=3, record="kept")
    audit = audit_runs(["kept"]).runs[0]
    checked = {part.name: part for part in audit.checks}
    assert not audit.findings
    assert checked["limits"].compared > 100


def test_a_recorded_run_knows_what_was_commanded(workspace: Path) -> None:
    irsim.run(text=text("{delay: 0.3}"), seed=3, record="kept")
    trace = open_run("kept").trace()
    assert trace.command is not None
    np.testing.assert_allclose(trace.control[4:20, 0, 0], np.minimum(1.0, 0.3 * np.arange(1, 17)), atol=1e-6)
    assert np.all(trace.command[1:20, 0, 0] == 1.0)
    irsim.export_run("kept", "kept.npz")
    with np.load("kept.npz") as arrays:
        assert np.array_equal(arrays["command"], trace.command)
        assert np.array_equal(trace.actions[:, 0], trace.command[:, 0])
    irsim.run(text=text(), seed=3, record="plain")
    assert open_run("plain").trace().command is None


def test_contacts_take_the_lag_of_actuators(make: Callable[..., Any]) -> None:
    """In `collision_mode: contact` the lag of `actuation` is exact, and `tau` takes dt / tau."""
    still = {
        "behavior: {name: dash}": "behavior: null",
        "acce: [3.0, 3.0], ": "",
        "goal_threshold": "friction: 50, goal_threshold",
    }
    new, old = (
        text("{lag: 0.5}", mode="contact"),
        text("null", mode="contact").replace("name: diff", "name: diff, tau: 0.5"),
    )
    speeds = []
    for scenario in (new, old):
        for before, after in still.items():
            scenario = scenario.replace(before, after)
        env = make(scenario)
        for _ in range(5):
            env.step([1.0, 0.0])
        speeds.append(float(env.robot.velocity[0, 0]))
        env.end()
    np.testing.assert_allclose(speeds, [1 - np.exp(-1), 1 - 0.8**5], atol=1e-12)


@pytest.mark.parametrize("hook", ["step", "gen_behavior_vel", "mid_process", "pre_process", "post_process"])
def test_an_overridden_part_of_a_step_changes_nothing_of_the_dead_time(make: Callable[..., Any], hook: str) -> None:
    """An overridden `step` moves the object again from where it was; its actuators go on once per step."""
    plain = text("{delay: 0.2, lag: 0.3, jerk: 5}").replace("behavior: {name: dash}", "behavior: null")
    env, other = make(plain), make(plain)
    usual = getattr(env.robot, hook)
    setattr(env.robot, hook, lambda *given, **named: usual(*given, **named))
    for step in range(12):
        for one in (env, other):
            one.step([0.1 * step, 0.0])
        np.testing.assert_allclose(env.robot.velocity, other.robot.velocity, atol=1e-12)
    assert env.robot.velocity[0, 0] > 0.2
    env.end()
    other.end()


@pytest.mark.parametrize("way", ["copy", "snapshot"])
def test_copies_within_a_dead_time_go_on_as_the_original(make: Callable[..., Any], way: str) -> None:
    env = make(text(WHOLE.replace("0.15", "0.55")))
    for _ in range(7):
        env.step()
    other = copy.deepcopy(env) if way == "copy" else make(text(WHOLE.replace("0.15", "0.55")))
    if way == "snapshot":
        other.restore(env.snapshot())
    for _ in range(20):
        env.step()
        other.step()
    assert np.array_equal(env.robot.state, other.robot.state)
    assert np.array_equal(env.robot.velocity, other.robot.velocity)
    assert env.robot.velocity[0, 0] > 0.5


def test_drives_in_python_have_actuators_up_to_three_controls(make: Callable[..., Any]) -> None:
    for count in (2, 4):

        @register_kinematics(f"sled_{count}")
        class Sled(KinematicsHandler):
            action_dim, vel_max, vel_min, acce = count, (1.0,) * count, (-1.0,) * count, (99.0,) * count

            def step(self, state: Any, velocity: Any, step_time: float) -> Any:
                return state + np.vstack([velocity[:2], np.zeros((1, 1))]) * step_time

    scene = "robot: {kinematics: {name: sled_2}, state: [1, 1, 0], goal: null, actuation: {delay: [0.2, 0.1]}}"
    env = make(scene)
    ways = []
    for _ in range(4):
        env.step([0.5, 0.25])
        ways.append(env.robot.state[:2, 0].tolist())
    np.testing.assert_allclose(ways, [[1, 1], [1, 1.025], [1.05, 1.05], [1.1, 1.075]], atol=1e-12)
    env.end()
    with pytest.raises(irsim.ScenarioError, match="actuation of more than 3 controls"):
        make(scene.replace("sled_2", "sled_4").replace("[0.2, 0.1]", "0.2"))
