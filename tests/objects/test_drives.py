"""Drives of users: constructed per object, limited like others, in batches, with sensors, collisions and behaviors."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.diagnostics.errors import BehaviorError
from irsim.lib import KinematicsFactory, KinematicsHandler, differential_kinematics, register_kinematics

Make = Callable[..., irsim.Env]


def register_unicycle() -> list[Any]:
    """A differential drive in Python; returns the handlers constructed."""
    made: list[Any] = []

    @register_kinematics("Unicycle")
    class Unicycle(KinematicsHandler):
        """Like `diff`, with a counter as fourth state row."""

        state_dim = 4
        vel_max = (1.5, 2.0)
        color = "c"
        obstacle_color = "m"

        def __init__(self, name: str, noise: bool, alpha: Any, gain: float = 1.0) -> None:
            super().__init__(name, noise, alpha)
            self.gain = gain
            made.append(self)

        def step(self, state: Any, velocity: Any, step_time: float) -> Any:
            assert state.shape == (4, 1)
            assert velocity.shape == (2, 1)
            theta, (v, w) = state[2, 0], velocity[:, 0] * step_time
            way = self.gain * v
            return state + np.array([[way * math.cos(theta)], [way * math.sin(theta)], [w], [1.0]])

    return made


SCENARIO = """
robot:
  - kinematics: {name: %s}
    shape: {name: circle, radius: 0.2}
    state: [1, 1, 0.5]
    goal: [8, 4]
    vel_min: [-1.5, -2]
    vel_max: [1.5, 2]
    acce: [2, 4]
    behavior: %s
    sensors: [{name: lidar2d, number: 9, angle_range: 3.0}]
obstacle:
  - {shape: {name: circle, radius: 0.5}, state: [3, 3, 0]}
"""


def test_a_drive_written_like_ours_moves_like_ours(make: Make) -> None:
    register_unicycle()
    env, ours = make(SCENARIO % ("unicycle", "null"), strict=True), make(SCENARIO % ("diff", "null"))
    for step in range(40):
        for each in (env, ours):
            each.step([1.0 + 0.01 * step, 0.2])
        assert env.robot.state[:3] == pytest.approx(ours.robot.state, abs=1e-12)
        assert env.robot.velocity == pytest.approx(ours.robot.velocity, abs=1e-12)
        assert env.get_lidar_scan()["ranges"] == pytest.approx(ours.get_lidar_scan()["ranges"], abs=1e-9)
        assert env.robot.velocity_xy == pytest.approx(ours.robot.velocity_xy, abs=1e-12)
        assert env.robot.collision == ours.robot.collision
    assert env.robot.collision, "it has run into the obstacle"
    assert env.robot.state[3, 0] == len(env.robot.trajectory) < 40, "and stands since"
    env.reset()
    assert env.robot.state[:, 0].tolist() == [1.0, 1.0, 0.5, 0.0]


@pytest.mark.parametrize("behavior", ["{name: dash}", "{name: orca}"])
def test_built_in_behaviors_drive_it_to_the_goal(make: Make, behavior: str) -> None:
    register_unicycle()
    text = (SCENARIO % ("unicycle", behavior)).replace("state: [3, 3, 0]", "state: [4, 8, 0]")
    env = make(text)
    env.rollout(400)
    assert env.robot.arrive


def test_its_own_conversion_of_velocities_is_used(make: Make) -> None:
    @register_kinematics("sledge")
    class Sledge(KinematicsHandler):
        def step(self, state: Any, velocity: Any, step_time: float) -> Any:
            return state + np.array([[velocity[0, 0]], [velocity[1, 0]], [0.0]]) * step_time

        def velocity_to_xy(self, state: Any, velocity: Any) -> Any:
            return velocity[:2]

        def velocity_from_xy(self, state: Any, velocity_xy: Any) -> Any:
            return velocity_xy

        def compute_max_speed(self, vel_max: Any) -> float:
            return 7.0

        def compute_heading(self, state: Any, velocity: Any) -> float:
            return 1.25

    env = make(SCENARIO % ("sledge", "{name: dash}"))
    env.step()
    wanted = np.array([7.0, 3.0]) / math.hypot(7, 3) * 1.5
    assert env.robot.velocity[:, 0] == pytest.approx(np.clip(wanted, [-0.2, -0.4], [0.2, 0.4]))
    assert env.robot.velocity_xy[:, 0] == pytest.approx(env.robot.velocity[:, 0])
    assert (env.robot.max_speed, env.robot.heading) == (7.0, 1.25)
    assert env.robot.kf.name == "sledge"


def test_limits_colours_and_rows_of_the_class_are_the_defaults(make: Make) -> None:
    made = register_unicycle()
    text = "{kinematics: {name: UNICYCLE, gain: 2.0, noise: true, alpha: [1, 2, 3, 4]}, state: [2, 2, 0]}"
    env = make(f"robot: [{text}]\nobstacle: [{{kinematics: {{name: unicycle}}, state: [6, 6, 0]}}]")
    robot, obstacle = env.objects
    assert robot.vel_max[:, 0].tolist() == [1.5, 2.0]
    assert robot.vel_min[:, 0].tolist() == [-1.0, -1.0]
    assert robot.state.shape == (4, 1)
    assert (robot.color, obstacle.color) == ("c", "m")
    assert [(h.name, h.gain, h.noise) for h in made] == [("unicycle", 2.0, True), ("unicycle", 1.0, False)]
    assert list(made[0].alpha) == [1, 2, 3, 4]


def test_a_key_that_the_constructor_does_not_take(make: Make) -> None:
    register_unicycle()
    with pytest.raises(TypeError, match="grip"):
        make("robot: {kinematics: {name: unicycle, grip: 3}, state: [2, 2, 0]}")


def test_four_wheels(make: Make) -> None:
    @register_kinematics("four_wheels")
    class FourWheels(KinematicsHandler):
        action_dim = 4
        vel_max = (5.0,) * 4
        vel_min = (-5.0,) * 4
        acce = (math.inf, math.inf, math.inf, 10.0)

        def step(self, state: Any, velocity: Any, step_time: float) -> Any:
            return state + np.array([[velocity.mean()], [0.0], [0.0]]) * step_time

    env = make("robot: {kinematics: {name: four_wheels}, state: [1, 1, 0], goal: [9, 1], velocity: [0, 0, 0, 1]}")
    env.step([1, 2, 9, 4])
    assert env.robot.velocity[:, 0].tolist() == [1, 2, 5, 2]
    assert env.robot.state[0, 0] == pytest.approx(1.25)
    env.step()
    assert env.robot.velocity[:, 0].tolist() == [0, 0, 0, 0], "without behavior and action it stands"
    env.reset()
    assert env.robot.velocity[:, 0].tolist() == [0, 0, 0, 1]
    env = make("robot: {kinematics: {name: four_wheels}, state: [1, 1, 0], goal: [9, 1], behavior: {name: dash}}")
    with pytest.raises(BehaviorError, match="velocity_from_xy"):
        env.step()


def test_in_a_batch_each_world_is_the_one_alone(make: Make, tmp_path: Path) -> None:
    made = register_unicycle()
    text = """
robot:
  - number: 3
    kinematics: {name: unicycle}
    shape: {name: circle, radius: 0.1}
    distribution: {name: random}
    behavior: {name: dash, wander: true}
"""
    alone = make(text, seed=8)
    batch = irsim.batch(tmp_path / "scenario.yaml", 3, seeds=[7, 8, 9])
    assert len(made) == 12
    for _ in range(20):
        alone.step()
        batch.step()
    assert (batch.pose[1] == alone.simulation.pose).all()
    assert (batch.extra[1] == alone.simulation.extra).all()
    batch.reset(mask=[False, True, False])
    alone.reset(random=True)
    batch.step()
    alone.step()
    assert (batch.pose[1] == alone.simulation.pose).all()


def test_what_is_no_state_is_said_so(make: Make) -> None:
    @register_kinematics("broken")
    class Broken(KinematicsHandler):
        def step(self, state: Any, velocity: Any, step_time: float) -> Any:
            return state * math.nan

    env = make("robot: {kinematics: {name: broken}, state: [1, 1, 0]}")
    with pytest.raises(BehaviorError, match="broken"):
        env.step()


def test_rows_that_a_drive_leaves_out_keep_their_values(make: Make) -> None:
    @register_kinematics("short")
    class Short(KinematicsHandler):
        state_dim = 5

        def step(self, state: Any, velocity: Any, step_time: float) -> Any:
            return state[:4] + 1.0

    env = make("robot: {kinematics: {name: short}, state: [1, 1, 0, 5, 6]}")
    env.step()
    assert env.robot.state[:, 0].tolist() == [2.0, 2.0, 1.0, 6.0, 6.0]


def test_names_are_registered_once() -> None:
    register_unicycle()
    with pytest.raises(ValueError, match="already registered"):
        register_unicycle()
    with pytest.raises(ValueError, match="already registered"):
        register_kinematics("diff")(KinematicsHandler)
    with pytest.raises(TypeError, match="KinematicsHandler"):
        register_kinematics("odd")(object)  # type: ignore[type-var]
    assert KinematicsFactory.get_handler_class("unicycle") is not None
    assert KinematicsFactory.create_kinematics("unicycle", gain=3.0).gain == 3.0  # type: ignore[attr-defined]


@pytest.mark.parametrize("integration", ["euler", "exact"])
@pytest.mark.parametrize("name", ["diff", "acker", "omni", "omni_angular"])
def test_handlers_of_built_in_drives_move_like_the_engine(make: Make, name: str, integration: str) -> None:
    controls = [0.7, 0.3, 0.4][: 3 if name == "omni_angular" else 2]
    text = f"robot: {{kinematics: {{name: {name}}}, state: [2, 2, 0.3, 0.1]}}"
    env = make(f"world: {{integration: {integration}}}\n{text}")
    handler = env.robot.kf
    assert handler is not None
    state = np.array(env.robot.state)
    env.step(controls)
    column = np.array(controls)[:, None]
    assert handler.step(state, column, 0.1) == pytest.approx(env.robot.state, abs=1e-12)
    assert handler.velocity_to_xy(env.robot.state, column) == pytest.approx(env.robot.velocity_xy, abs=1e-12)
    assert handler.compute_max_speed(env.robot.vel_max) == pytest.approx(env.robot.max_speed)
    assert handler.compute_heading(env.robot.state, column) == pytest.approx(env.robot.heading)


def test_a_drive_learns_how_the_scenario_integrates(make: Make) -> None:
    @register_kinematics("arcs")
    class Arcs(KinematicsHandler):
        def step(self, state: Any, velocity: Any, step_time: float) -> Any:
            return differential_kinematics(state, velocity, step_time, integration=self.integration)

    for integration in ("euler", "exact"):
        text = "world: {integration: %s}\nrobot: {kinematics: {name: %s}, state: [2, 2, 0.3]}"
        envs = [make(text % (integration, name)) for name in ("arcs", "diff")]
        for env in envs:
            env.step([0.9, 0.8])
        assert envs[0].robot.state == pytest.approx(envs[1].robot.state, abs=1e-15)


def test_objects_with_it_come_and_go(make: Make) -> None:
    made = register_unicycle()
    env = make("robot: {kinematics: {name: diff}, state: [1, 1, 0]}")
    new = env.create_robot(kinematics={"name": "unicycle"}, state=[2, 5, 0], shape={"name": "circle", "radius": 0.1})
    env.add_object(new)
    env.step({new.id: [0.5, 0.0]})
    assert new.state[:, 0].tolist() == pytest.approx([2.05, 5, 0, 1])
    assert new.kf is made[-1]
    env.delete_object(0)
    env.step({new.id: [0.5, 0.0]})
    assert new.state[:, 0].tolist() == pytest.approx([2.10, 5, 0, 2])
    env.reset(random=True)
    assert [view.kinematics for view in env.objects] == ["diff"]
    env.step()


CONTACT = """
world: {width: 20, height: 20, collision_mode: contact}
robot:
  - {kinematics: {name: %s, tau: 0.2}, shape: {name: circle, radius: 0.2}, state: [5, 5, 0.1], mass: %s, friction: 0.5}
obstacle:
  - {shape: {name: rectangle, length: 0.4, width: 0.4}, state: [5.45, 5.05, 0.2], mass: 4, friction: 0.5}
"""


@pytest.mark.parametrize("mass", [1.0, 20.0])
def test_it_lags_grips_and_feels_contacts_like_ours(make: Make, mass: float) -> None:
    @register_kinematics("holonomic")
    class Holonomic(KinematicsHandler):
        action_dim, vel_max, vel_min, acce = 3, (1.0, 1.0, 1.0), (-1.0, -1.0, -1.0), (math.inf,) * 3
        translation_rows, yaw_rate_row = (0, 1), 2

        def step(self, state: Any, velocity: Any, step_time: float) -> Any:
            x, y = self.velocity_to_xy(state, velocity)[:, 0]
            return state + np.array([[x], [y], [velocity[2, 0]]]) * step_time

        def velocity_to_xy(self, state: Any, velocity: Any) -> Any:
            c, s = math.cos(state[2, 0]), math.sin(state[2, 0])
            return np.array([[c, -s], [s, c]]) @ velocity[:2]

        def velocity_from_xy(self, state: Any, velocity_xy: Any) -> Any:
            c, s = math.cos(state[2, 0]), math.sin(state[2, 0])
            return np.vstack([np.array([[c, s], [-s, c]]) @ velocity_xy, [[0.0]]])

    env, ours = make(CONTACT % ("holonomic", mass)), make(CONTACT % ("omni_angular", mass))
    for step in range(25):
        for each in (env, ours):
            each.step([0.9, 0.1 if step < 12 else -0.2, 0.05] if step < 20 else None)
        for a, b in zip(env.objects, ours.objects, strict=True):
            assert a.state == pytest.approx(b.state, abs=1e-9)
            assert a.velocity == pytest.approx(b.velocity, abs=1e-9)
        assert env.robot.drive_velocity_xy == pytest.approx(ours.robot.drive_velocity_xy, abs=2e-2)
        assert [c.force for c in env.contacts] == pytest.approx([c.force for c in ours.contacts], abs=1e-6)
    assert env.objects[1].state[0, 0] > 5.5 if mass > 10 else env.robot.state[0, 0] < 5.2
    env.reset()
    env.step([0.9, 0.0, 0.0])
    assert env.robot.velocity[0, 0] == pytest.approx(0.45), "lag from rest"


def test_more_controls_than_the_core_keeps_lag_grip_and_feel_contacts(make: Make) -> None:
    @register_kinematics("four_wheels")
    class FourWheels(KinematicsHandler):
        action_dim, vel_max, vel_min, acce = 4, (2.0,) * 4, (-2.0,) * 4, (math.inf,) * 4
        translation_rows = (0, 3)

        def step(self, state: Any, velocity: Any, step_time: float) -> Any:
            return state + np.array([[velocity[0, 0]], [velocity[3, 0]], [0.0]]) * step_time

        def velocity_to_xy(self, state: Any, velocity: Any) -> Any:
            return np.array([velocity[0], velocity[3]])

        def velocity_from_xy(self, state: Any, velocity_xy: Any) -> Any:
            return np.array([velocity_xy[0], [0.0], [0.0], velocity_xy[1]])

    wall = "{shape: {name: rectangle, length: 0.2, width: 4}, state: [5.5, 5, 0]}"
    env = make(
        "world: {width: 20, height: 20, collision_mode: contact, gravity: 10.0}\n"
        "robot: {kinematics: {name: four_wheels}, shape: {name: circle, radius: 0.2}, state: [5, 5, 0]}\n"
        f"obstacle: [{wall}]"
    )
    env.step([0.9, 0.3, 0.2, 1.2])
    assert env.robot.velocity[:, 0] == pytest.approx([0.3, 0.3, 0.2, 0.4]), "no more than friction allows"
    for _ in range(6):
        env.step([0.9, 0.3, 0.2, 1.2])
    assert env.robot.state[0, 0] == pytest.approx(5.2, abs=1e-5), "at the wall"
    assert env.robot.velocity[:, 0] == pytest.approx([0.0, 0.3, 0.2, 1.2], abs=1e-4)
    assert env.robot.drive_velocity_xy[:, 0] == pytest.approx([0.9, 1.2])
    assert env.contacts[0].force == pytest.approx(0.5 * 10.0 * env.robot.mass), "what its wheels can press"
    env.robot.apply_contact_velocity([0.0, -0.2])
    assert env.robot.velocity[3, 0] == pytest.approx(1.0)


def test_an_overridden_step_answers_a_command_once(make: Make) -> None:
    plain, hooked = make(CONTACT % ("diff", 20)), make(CONTACT % ("diff", 20))
    robot = hooked.robot
    usual = robot.step
    robot.step = lambda *args, **kwargs: usual(*args, **kwargs)
    for _ in range(10):
        for each in (plain, hooked):
            each.step([0.8, 0.1])
        for a, b in zip(plain.objects, hooked.objects, strict=True):
            assert a.state == pytest.approx(b.state, abs=1e-12)
            assert a.velocity == pytest.approx(b.velocity, abs=1e-12)
