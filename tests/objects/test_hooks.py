"""Objects with steps, or parts of steps, of their own."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.objects.extensions.hooks import HOOKS, overridden
from irsim.objects.view import ObjectView

Make = Callable[..., irsim.Env]
SCENARIO = """
robot:
  - {kinematics: {name: diff}, shape: &body {name: circle, radius: 0.2}, state: [1, 1, 0], goal: [9, 1],
     behavior: {name: dash}}
  - {kinematics: {name: omni}, shape: *body, state: [1, 4, 0], goal: [9, 6], behavior: {name: dash}}
obstacle:
  - {kinematics: {name: diff}, shape: *body, state: [5, 8, 0], behavior: {name: dash, wander: true}}
"""


def spy(view: Any, name: str, log: list[Any]) -> None:
    """Note when a method is called, with the pose then."""
    method = getattr(view, name)

    def noting(*args: Any, **kwargs: Any) -> Any:
        log.append((name, view.state[:, 0].tolist()))
        return method(*args, **kwargs)

    setattr(view, name, noting)


def test_patched_methods_are_called_at_their_moments(make: Make) -> None:
    env, plain = make(SCENARIO), make(SCENARIO)
    log: list[Any] = []
    for name in HOOKS:
        spy(env.robot, name, log)
    start = env.robot.state[:, 0].tolist()
    for each in (env, plain):
        each.step()
    names = [name for name, _ in log]
    assert sorted(names) == sorted(HOOKS)
    order = [name for name in names if name != "step"]
    assert order == ["pre_process", "gen_behavior_vel", "mid_process", "post_process"]
    at = dict(log)
    assert at["mid_process"] == start, "the state counts after it"
    assert at["post_process"] == env.robot.state[:, 0].tolist() != start
    for _ in range(30):
        for each in (env, plain):
            each.step()
    assert (env.simulation.pose == plain.simulation.pose).all()
    assert len(env.robot.trajectory) == 31


def test_parts_of_a_step_are_called_in_order_without_a_step_of_its_own(make: Make) -> None:
    env = make(SCENARIO)
    log: list[Any] = []
    names = ["pre_process", "gen_behavior_vel", "mid_process", "post_process"]
    for name in names:
        spy(env.robot, name, log)
    start = env.robot.state[:, 0].tolist()
    env.step()
    assert [name for name, _ in log] == names
    assert [pose for _, pose in log] == [start, start, start, env.robot.state[:, 0].tolist()]


@pytest.mark.parametrize("name", HOOKS)
def test_each_alone_changes_nothing_by_being_patched(make: Make, name: str) -> None:
    env, plain = make(SCENARIO), make(SCENARIO)
    log: list[Any] = []
    for view in env.objects:
        spy(view, name, log)
    for _ in range(25):
        for each in (env, plain):
            each.step()
        assert (env.simulation.pose == plain.simulation.pose).all()
        assert (env.simulation.control == plain.simulation.control).all()
    assert len(log) == 75


def test_mid_process_decides_where_it_ends(make: Make) -> None:
    env = make(SCENARIO)

    def on_rails(state: Any) -> Any:
        state[1, 0] = 1.5
        return state

    env.robot.mid_process = on_rails
    env.step([0.5, 0.9])
    assert env.robot.state[:, 0].tolist() == pytest.approx([1.05, 1.5, 0.09])
    assert env.robot.velocity[:, 0].tolist() == [0.5, 0.9]


def test_a_step_of_its_own_replaces_the_motion(make: Make) -> None:
    env = make(SCENARIO)
    robot = env.robot
    given: list[Any] = []

    def jump(velocity: Any = None, sensor_step: bool = True, **_: Any) -> Any:
        given.append((None if velocity is None else np.asarray(velocity)[:, 0].tolist(), sensor_step))
        robot.set_state([robot.state[0, 0] + 1.0, 2.0, 0.0])
        return robot.state

    robot.step = jump
    env.step()
    env.step([0.5, 0.0])
    assert given == [(None, False), ([0.5, 0.0], False)]
    assert robot.state[:, 0].tolist() == [3.0, 2.0, 0.0]
    assert [state[0, 0] for state in robot.trajectory] == [2.0, 3.0]
    del robot.step
    env.step()
    assert robot.state[0, 0] == pytest.approx(3.1, abs=0.01), "as before"


def test_a_subclass_takes_part_by_what_it_overrides(make: Make) -> None:
    class Patrol(ObjectView):
        calls = 0

        def pre_process(self) -> None:
            super().pre_process()
            self.calls += 1

        def gen_behavior_vel(self, velocity: Any = None) -> Any:
            return 0.5 * super().gen_behavior_vel(velocity)

    env = make(SCENARIO)
    patrol = Patrol(env.simulation, 0)
    assert overridden(patrol) == {"pre_process", "gen_behavior_vel"}
    env.step()
    assert patrol.calls == 1
    assert env.robot.velocity[0, 0] == pytest.approx(0.5)


def test_a_subclass_of_a_subclass_takes_part_by_what_both_override(make: Make) -> None:
    class Slow(ObjectView):
        def gen_behavior_vel(self, velocity: Any = None) -> Any:
            return 0.5 * super().gen_behavior_vel(velocity)

    class SlowAndCounting(Slow):
        steps = 0

        def post_process(self) -> None:
            self.steps += 1

    env = make(SCENARIO)
    robot = SlowAndCounting(env.simulation, 0)
    assert overridden(robot) == {"gen_behavior_vel", "post_process"}
    env.step()
    assert robot.steps == 1
    assert env.robot.velocity[0, 0] == pytest.approx(0.5)


def test_a_wanderer_without_its_renewal_stays_at_its_goal(make: Make) -> None:
    text = """
robot: {kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [1, 1, 0], goal: [1.5, 1],
        behavior: {name: dash, loop: true}}
"""
    free, held = make(text), make(text)
    held.robot.pre_process = lambda: None
    for env in (free, held):
        for _ in range(40):
            env.step()
    assert held.robot.arrive
    assert len({round(float(state[0, 0]), 6) for state in free.robot.trajectory[20:]}) > 3
    assert len({round(float(state[0, 0]), 6) for state in held.robot.trajectory[20:]}) == 1


def test_one_object_steps_alone(make: Make) -> None:
    env = make(SCENARIO)
    before = [view.state[:, 0].tolist() for view in env.objects]
    state = env.robot.step([0.5, 0.2])
    assert state[:, 0].tolist() == pytest.approx([1.05, 1.0, 0.02])
    assert env.robot.step()[0, 0] > 1.05, "its behavior drives it"
    assert env.time == 0.0
    assert len(env.robot.trajectory) == 2
    assert [view.state[:, 0].tolist() for view in env.objects[1:]] == before[1:]
    assert env.robot.gen_behavior_vel()[0, 0] == pytest.approx(1.0, abs=1e-3)
    assert env.robot.gen_behavior_vel([9.0, 0.0])[:, 0].tolist() == [1.0, 0.0]
    with pytest.raises(ValueError, match="2 numbers"):
        env.robot.step([1.0, 2.0, 3.0])


def test_worlds_without_anything_overridden_stay_in_the_core(make: Make) -> None:
    env = make(SCENARIO)
    env.step()
    assert env.simulation.hooks is None
    assert not env.simulation.in_python


def test_what_comes_and_goes_keeps_its_own_steps(make: Make) -> None:
    env = make(SCENARIO)
    calls: list[str] = []
    env.objects[1].post_process = lambda: calls.append("second")
    new = env.create_robot(kinematics={"name": "diff"}, state=[2, 8, 0], shape={"name": "circle", "radius": 0.1})
    new.post_process = lambda: calls.append("new")
    env.add_object(new)
    env.step()
    assert calls == ["second", "new"]
    env.delete_object(0)
    env.step()
    assert calls == ["second", "new"] * 2
    env.delete_object(env.objects[0].id)
    env.step()
    assert calls[4:] == ["new"]
