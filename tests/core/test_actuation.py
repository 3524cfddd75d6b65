"""Actuators: hold, dead time, resolution, limits with jerk, lag, dead band, noise, each against numbers by hand."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import strategies as st

import irsim._core as core
from irsim.common.arrays import Floats
from tests.core.worlds import DRIVES, apply, assert_identical, circle, command, everything, robot, rows_of, scene
from tests.effort import for_all

Command = Callable[[int], Sequence[float]]
FAST = {"vel_min": [-9.0] * 3, "vel_max": [9.0] * 3}
ALL = {"command_period": 0.2, "delay": [0.25, 0.1, 0.0], "resolution": 0.01, "jerk": 8.0, "lag": [0.1, 0.3, 0.2],
       "dead_band": 0.02, "noise": 0.05}  # fmt: skip


def actuation(**given: Any) -> core.Actuation:
    """Actuators, of which a number holds for all controls."""
    usual: dict[str, Any] = {"command_period": 0.0, "jerk": math.inf}
    for key in ("delay", "resolution", "lag", "dead_band", "noise"):
        usual[key] = 0.0
    values = {**usual, **given}
    each = {key: [value] * 3 if isinstance(value, float) else value for key, value in values.items()}
    return core.Actuation(**{**each, "command_period": values["command_period"]})


def executed(commands: Command, steps: int, step_time: float = 0.1, seed: int = 0, **given: Any) -> Floats:
    """(steps, 3) controls that a differential drive executes."""
    own = {key: given.pop(key) for key in ("acce", "control", "vel_min", "vel_max") if key in given}
    world, state = scene(
        robot(behavior=None, actuation=actuation(**given), **{**FAST, **own}), step_time=step_time, seeds=[seed]
    )
    out = []
    for step in range(steps):
        apply(world, state, commands(step))
        out.append(state.control[0].copy())
    return np.array(out)


def one(step: int) -> list[float]:
    return [1.0, 0.0]


def ramp(step: int) -> list[float]:
    return [float(step), -0.5 * step]


@pytest.mark.parametrize(("lag", "step_time"), [(0.5, 0.1), (0.3, 0.001), (0.2, 0.2)])
def test_a_lag_executes_63_percent_after_its_time(lag: float, step_time: float) -> None:
    steps = round(lag / step_time)
    done = executed(one, steps + 1, step_time, lag=lag)[:, 0]
    assert done[steps - 1] == pytest.approx(1 - math.exp(-1), abs=1e-12)
    crossing = np.interp(1 - math.exp(-1), done, step_time * np.arange(1, steps + 2))
    assert crossing == pytest.approx(lag, abs=step_time / 1000)


def test_a_lag_does_not_depend_on_the_step() -> None:
    coarse = executed(one, 8, 0.25, lag=[0.4, 0.1, 0.0])
    fine = executed(one, 2000, 0.001, lag=[0.4, 0.1, 0.0])
    np.testing.assert_allclose(coarse, fine[249::250], atol=1e-12)


@pytest.mark.parametrize("steps", [1, 2, 7, 20])
@pytest.mark.parametrize("step_time", [0.1, 0.03, 1 / 3])
def test_a_dead_time_of_whole_steps_is_exact(steps: int, step_time: float) -> None:
    done = executed(ramp, 40, step_time, vel_max=[99.0] * 3, vel_min=[-99.0] * 3, delay=steps * step_time)
    wanted = np.array([[*ramp(max(0, step - steps)), 0.0] for step in range(40)])
    assert np.array_equal(done, wanted)


@pytest.mark.parametrize("delay", [0.05, 0.15, 0.17, 0.999])
def test_a_dead_time_between_steps_lies_on_the_line_between_two_commands(delay: float) -> None:
    done = executed(lambda step: [math.sin(step), math.cos(step)], 30, delay=delay)
    sent = np.array([[math.sin(step), math.cos(step)] for step in range(30)])
    for column in range(2):
        wanted = np.interp(0.1 * np.arange(15, 30) - delay, 0.1 * np.arange(30), sent[:, column])
        np.testing.assert_allclose(done[15:, column], wanted, atol=1e-12)


def test_half_a_step_of_dead_time_is_the_mean_of_two_commands() -> None:
    done = executed(lambda step: [float(step % 2), 0.0], 6, delay=0.05)
    assert done[:, 0].tolist() == [0.0, 0.5, 0.5, 0.5, 0.5, 0.5]


def test_each_control_has_its_own_dead_time() -> None:
    done = executed(ramp, 8, delay=[0.3, 0.1, 0.0])
    assert done[7, :2].tolist() == [4.0, -3.0]


def test_a_command_is_held_for_its_period() -> None:
    done = executed(ramp, 10, command_period=0.3)
    assert done[:, 0].tolist() == [0, 0, 0, 3, 3, 3, 6, 6, 6, 9]
    uneven = executed(lambda step: [step / 10, 0.0], 21, command_period=0.25)[:, 0]
    begins = [0] + [step for step in range(1, 21) if uneven[step] != uneven[step - 1]]
    assert begins == [0, 3, 5, 8, 10, 13, 15, 18, 20]  # 2.5 steps on average


def test_a_short_period_holds_nothing() -> None:
    assert np.array_equal(executed(ramp, 9, command_period=0.1), executed(ramp, 9, command_period=0.0))


def test_commands_are_rounded_to_the_resolution() -> None:
    done = executed(lambda step: [0.1 * step, -0.1 * step], 11, resolution=[0.25, 0.4, 0.0])
    np.testing.assert_allclose(done[:, 0], np.round(np.arange(11) * 0.4 + 1e-9) * 0.25, atol=1e-12)
    np.testing.assert_allclose(done[:, 1], -np.round(np.arange(11) * 0.25 + 1e-9) * 0.4, atol=1e-12)


@for_all(
    60,
    targets=st.lists(st.floats(-2, 2), min_size=1, max_size=4),
    jerk=st.floats(0.3, 60),
    acce=st.sampled_from([0.4, 2.0, 15.0, math.inf]),
    step_time=st.sampled_from([0.02, 0.1]),
)
def test_jerk_bounds_the_change_of_the_acceleration_without_overshoot(targets, jerk, acce, step_time) -> None:
    hold = 40
    done = executed(
        lambda step: [targets[min(step // hold, len(targets) - 1)], 0.0],
        hold * len(targets), step_time, jerk=jerk, acce=[acce] * 3, vel_min=[-1.5] * 3, vel_max=[1.5] * 3,
    )[:, 0]  # fmt: skip
    rate = np.diff(done, prepend=0.0) / step_time
    assert np.abs(np.diff(rate, prepend=0.0)).max() <= jerk * step_time * (1 + 1e-9) + 1e-9
    assert np.abs(rate).max() <= acce * (1 + 1e-9)
    assert np.abs(done).max() <= 1.5 + 1e-9
    first = min(max(targets[0], -1.5), 1.5)
    assert np.all(done[:hold] * np.sign(first) <= abs(first) + 1e-9), "it does not overshoot"


def test_jerk_takes_the_shortest_time() -> None:
    """Rise, constant acceleration and fall of the closed form: v / a + a / j."""
    done = executed(one, 3000, 0.001, jerk=5.0, acce=[2.0] * 3)[:, 0]
    assert 0.001 * (np.argmax(done >= 1.0) + 1) == pytest.approx(1 / 2 + 2 / 5, abs=0.003)
    short = executed(one, 3000, 0.001, jerk=5.0)[:, 0]
    assert 0.001 * (np.argmax(short >= 1.0) + 1) == pytest.approx(2 * math.sqrt(1 / 5), abs=0.003)
    assert done[-1] == short[-1] == 1.0


def test_without_jerk_the_limits_are_those_of_other_objects() -> None:
    rng = np.random.default_rng(3)
    commands = rng.uniform(-3, 3, (50, 2))
    limits = {"acce": [1.0, 7.0, 1.0], "vel_min": [-0.5, -2.0, -1.0], "vel_max": [1.0, 2.0, 1.0]}
    world, state = scene(robot(behavior=None, **limits))
    plain = []
    for control in commands:
        apply(world, state, control)
        plain.append(state.control[0].copy())
    assert np.array_equal(executed(lambda step: commands[step], 50, **limits), plain)


def test_controls_within_the_dead_band_are_zero() -> None:
    done = executed(lambda step: [0.1 * step - 0.5, 0.05 * step], 11, dead_band=[0.25, 0.31, 0.0])
    np.testing.assert_allclose(done[:, 0], [-0.5, -0.4, -0.3, 0, 0, 0, 0, 0, 0.3, 0.4, 0.5], atol=1e-12)
    np.testing.assert_allclose(done[:, 1], [0, 0, 0, 0, 0, 0, 0, 0.35, 0.4, 0.45, 0.5], atol=1e-12)


def test_the_order_is_fixed() -> None:
    """Rounding acts on the delayed command, the dead band on the lagged control."""
    done = executed(one, 5, delay=0.05, resolution=0.8, lag=0.1, dead_band=0.6, acce=[5.0] * 3)[:, 0]
    part, lagged, setpoint, wanted = 1 - math.exp(-1), 0.0, 0.0, []
    for command_then in (0.8, 0.8, 0.8, 0.8, 0.8):  # 0.5 and 1 round to 0.8
        setpoint = min(command_then, setpoint + 0.5)
        lagged += (setpoint - lagged) * part
        wanted.append(0.0 if lagged < 0.6 else lagged)
    np.testing.assert_allclose(done, wanted, atol=1e-12)


def test_noise_is_white_and_unbiased() -> None:
    noise = executed(one, 4000, noise=[0.1, 0.03, 0.0])[:, :2] - [1.0, 0.0]
    z = noise / [0.1, 0.03]
    assert np.abs(z.mean(axis=0)).max() <= 4 / math.sqrt(len(z))
    assert np.abs((z**2).mean(axis=0) - 1).max() <= 4 * math.sqrt(2 / len(z))
    assert abs((z[1:] * z[:-1]).mean()) <= 4 / math.sqrt(len(z)), "successive draws are independent"
    assert abs((z[:, 0] * z[:, 1]).mean()) <= 4 / math.sqrt(len(z)), "controls have draws of their own"
    assert np.array_equal(executed(one, 50, noise=0.1), executed(one, 50, noise=0.1))
    assert not np.array_equal(executed(one, 50, noise=0.1), executed(one, 50, noise=0.1, seed=1))


def test_noise_lasts_as_long_as_a_command() -> None:
    done = executed(one, 12, noise=0.1, command_period=0.4)[:, 0]
    assert [len(set(done[k : k + 4])) for k in (0, 4, 8)] == [1, 1, 1]
    assert len(set(done)) == 3


def test_what_stands_does_not_tremble() -> None:
    assert not executed(lambda step: [0.0, 0.0], 20, noise=0.1).any()


def test_without_a_command_it_is_told_to_stop() -> None:
    world, state = scene(robot(behavior=None, actuation=actuation(delay=0.2), **FAST))
    apply(world, state, [1.0, 0.0], steps=5)
    core.advance(world, state, 2)
    assert state.control[0, 0] == 1.0
    core.advance(world, state, 1)
    assert state.control[0, 0] == 0.0


def test_a_robot_that_starts_in_motion_goes_on_during_the_dead_time() -> None:
    done = executed(lambda step: [0.0, 0.0], 4, delay=0.2, control=[0.5, 0.0, 0.0])
    assert done[:, 0].tolist() == [0.5, 0.5, 0.0, 0.0]


def test_what_was_stopped_begins_at_rest() -> None:
    world, state = scene(robot(behavior=None, actuation=actuation(delay=0.2, lag=0.3), **FAST))
    apply(world, state, [1.0, 0.0], steps=9)
    state.stopped[0] = 1
    apply(world, state, [1.0, 0.0], steps=1)
    assert not state.control[0].any()
    state.stopped[0] = 0
    apply(world, state, [1.0, 0.0], steps=2)
    assert not state.control[0].any(), "commands from before the stop do not come through"


def test_a_late_start_begins_at_rest() -> None:
    world, state = scene(robot(behavior=None, start_step=3, actuation=actuation(delay=0.1), **FAST))
    apply(world, state, [1.0, 0.0], steps=4)
    assert not state.control[0].any()
    apply(world, state, [1.0, 0.0])
    assert state.control[0, 0] == 1.0


@pytest.mark.parametrize("drive", DRIVES)
def test_every_drive_moves_by_the_executed_control(drive: str) -> None:
    """An object without actuators that is commanded what this one executes has the same pose."""
    start = {"drive": DRIVES[drive], "pose": [1.0, 2.0, 0.3], "behavior": None}
    world, state = scene(robot(actuation=actuation(**ALL), **start, acce=[2.0, 3.0, 3.0]), seeds=[4])
    plain, other = scene(robot(**start, vel_min=[-9.0] * 3, vel_max=[9.0] * 3))
    for step in range(40):
        apply(world, state, [0.5 + 0.4 * math.sin(0.2 * step), 0.4 * math.cos(0.1 * step), 0.3])
        apply(plain, other, state.control[0])
        np.testing.assert_allclose(state.pose[0], other.pose[0], atol=1e-12)
        np.testing.assert_allclose(state.extra[0], other.extra[0], atol=1e-12)
    assert np.abs(state.pose[0, :2] - [1.0, 2.0]).max() > 0.3


def crowd(seeds: Sequence[int], mode: int = 1) -> tuple[core.World, core.State]:
    """Objects of every drive with actuators among objects without them."""
    objects = []
    for k, drive in enumerate(4 * [*DRIVES.values()]):
        place = [0.7 * (k % 5), 0.8 * (k // 5), 0.4 * k]
        goal = [[9.0 - place[0], 9.0 - place[1]]]
        own = {"actuation": actuation(**{**ALL, "delay": 0.03 * k})} if k % 3 else {}
        objects.append(robot(drive=drive, pose=place, goals=goal, parts=[circle(0.15)], acce=[3.0] * 3, **own))
    return scene(*objects, seeds=seeds, mode=mode)


@pytest.mark.parametrize("mode", [0, 1, 3])
def test_a_batch_equals_single_worlds_on_any_number_of_threads(mode: int) -> None:
    seeds = [3, 1, 4, 15, 9]
    results = []
    for threads in (1, 2, 3):
        world, state = crowd(seeds, mode)
        core.advance(world, state, 45, threads=threads)
        results.append(everything(state))
    assert_identical(results[0], results[1])
    assert_identical(results[0], results[2])
    for number, seed in enumerate(seeds):
        world, state = crowd([seed], mode)
        core.advance(world, state, 45)
        assert_identical(rows_of(results[0], number, len(seeds)), everything(state))


@pytest.mark.parametrize("mode", [1, 3])
def test_a_state_saved_within_a_dead_time_goes_on_as_it_would_have(mode: int) -> None:
    world, state = crowd([7, 8], mode)
    core.advance(world, state, 13)
    saved = state.save()
    core.advance(world, state, 30)
    again, other = crowd([7, 8], mode)
    other.load(saved)
    core.advance(again, other, 30)
    assert_identical(everything(state), everything(other))
    assert np.array_equal(state.actuated, other.actuated)


def test_a_reset_empties_the_queue() -> None:
    world, state = crowd([7])
    core.advance(world, state, 20)
    first = everything(state)
    state.reset(np.array([1], dtype=np.uint8), False)
    state.noise[0] = 0
    core.advance(world, state, 20)
    assert_identical(first, everything(state))


def test_objects_keep_their_queues_when_others_come_and_go() -> None:
    own = robot(behavior=None, number=0, actuation=actuation(delay=0.4, lag=0.2, jerk=9.0), **FAST)
    other = robot(behavior=None, number=1, pose=[5.0, 5.0, 0.0], actuation=actuation(delay=0.7), **FAST)
    world, state = scene(other, own, mode=1)
    alone, single = scene(own, mode=1)
    for step in range(12):
        command(state, [0.0, 0.0], [math.sin(step), 0.0])
        core.advance(world, state, 1)
        apply(alone, single, [math.sin(step), 0.0])
        if step == 6:  # the first object goes
            world = scene(own, mode=1)[0]
            state = core.State(world, state, [(state, 1)])
            break
    for step in range(7, 20):
        apply(world, state, [math.sin(step), 0.0])
        apply(alone, single, [math.sin(step), 0.0])
        assert np.array_equal(state.pose[0], single.pose[0])


def test_a_control_that_a_program_sets_is_where_actuators_go_on() -> None:
    world, state = scene(robot(behavior=None, actuation=actuation(lag=1.0), **FAST))
    state.control[0, 0] = 2.0
    state.rest(0)
    apply(world, state, [2.0, 0.0])
    assert state.control[0, 0] == 2.0


def test_imposed_controls_are_compared_with_the_limits_before_the_lag() -> None:
    world, state = scene(robot(behavior=None, actuation=actuation(lag=5.0), acce=[2.0] * 3, **FAST))
    assert not core.impose_row(world, state, 0, [0.2, 0.0])
    core.advance(world, state, 1)
    assert state.control[0, 0] < 0.01
    assert not core.impose_row(world, state, 0, [0.4, 0.0])
    assert core.impose_row(world, state, 0, [0.41, 0.0])
