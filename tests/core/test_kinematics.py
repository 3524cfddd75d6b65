"""Limits and forward Euler of every drive, against plain NumPy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import irsim._core as core
from tests.core import oracle
from tests.core.worlds import DRIVES, PI, command, robot, scene
from tests.effort import examples

NUMBER = st.floats(-3, 3)
THREE = st.lists(NUMBER, min_size=3, max_size=3)


@pytest.mark.parametrize("drive", DRIVES)
@settings(max_examples=examples(40))
@given(
    x=NUMBER, y=NUMBER, theta=st.floats(-PI, PI), psi=st.floats(-0.9, 0.9), wanted=THREE, before=THREE, data=st.data()
)
def test_one_period(drive: str, x, y, theta, psi, wanted, before, data) -> None:
    low = data.draw(st.lists(st.floats(-2, 0), min_size=3, max_size=3))
    high = data.draw(st.lists(st.floats(0, 2), min_size=3, max_size=3))
    acce = data.draw(st.lists(st.sampled_from([0.0, 0.5, 4.0, math.inf]), min_size=3, max_size=3))
    world, state = scene(
        robot(
            drive=DRIVES[drive], pose=[x, y, theta], extra=[psi], control=before, vel_min=low, vel_max=high, acce=acce
        ),
        step_time=0.2,
    )
    command(state, wanted)
    core.advance(world, state, 1)
    u = oracle.limited(*(np.array(v) for v in (wanted, before, low, high, acce)), 0.2)
    if drive == "angular":
        u[1:2] = u[1]
    pose, psi_after, twist = oracle.move(drive, np.array([x, y, theta]), psi, u, 0.2)
    np.testing.assert_allclose(state.control[0], u, atol=1e-15)
    np.testing.assert_allclose(state.pose[0], pose, atol=1e-12)
    np.testing.assert_allclose(state.twist[0], twist, atol=1e-12)
    if drive in ("steer", "angular"):
        assert state.extra[0, 0] == pytest.approx(psi_after, abs=1e-12)
    else:
        assert state.extra[0, 0] == psi


def test_crossed_limits_end_at_the_upper_one() -> None:
    world, state = scene(robot(control=[5, 0, 0], acce=[1.0, 1.0, 1.0]))
    command(state, [0.0, 0.0])
    core.advance(world, state, 1)
    assert state.control[0, 0] == 1.0  # 4.9 is the lower end of the window, vel_max the upper


def test_steering_is_limited_by_psi_max() -> None:
    drive = core.AckerOptions(noise=False, alpha=[0.0] * 4, mode="steer", wheelbase=1.0, psi_max=0.3)
    world, state = scene(robot(drive=drive))
    command(state, [1.0, -0.8])
    core.advance(world, state, 1)
    assert state.control[0, 1] == -0.3
    assert state.extra[0, 0] == -0.3


def test_steering_acts_one_period_late() -> None:
    world, state = scene(robot(drive=DRIVES["steer"]))
    command(state, [1.0, 0.5])
    core.advance(world, state, 1)
    assert state.pose[0, 2] == 0.0
    command(state, [1.0, 0.0])
    core.advance(world, state, 1)
    assert state.pose[0, 2] == pytest.approx(math.tan(0.5) / 1.2 * 0.1)


@pytest.mark.parametrize(("theta", "rate"), [(3.1, 1.0), (-3.1, -1.0), (0.5, 1.0)])
def test_heading_stays_in_its_interval(theta: float, rate: float) -> None:
    world, state = scene(robot(pose=[0, 0, theta], angle_range=[0.0, 2 * PI]))
    command(state, [0.0, rate])
    core.advance(world, state, 1)
    assert 0.0 <= state.pose[0, 2] <= 2 * PI
    assert math.cos(state.pose[0, 2] - theta - 0.1 * rate) == pytest.approx(1.0)


def test_static_and_stopped_objects_stay() -> None:
    touching = [robot(pose=[x, 0, 0], control=[1, 1, 0]) for x in (0.0, 0.3)]
    world, state = scene(*touching, robot(pose=[5, 0, 0], static=True, control=[1, 0, 0]))
    command(state, [1, 0], [1, 0], [1, 0])
    before = state.pose.copy()
    core.advance(world, state, 1)
    np.testing.assert_array_equal(state.pose, before)
    np.testing.assert_array_equal(state.control, 0.0)
    np.testing.assert_array_equal(state.twist, 0.0)


def test_a_row_without_native_drive_is_left_to_the_caller() -> None:
    world, state = scene(robot(drive=None, driven=True, behavior=None, pose=[1, 2, 3]))
    state.twist[0] = [7, 8, 9]
    core.advance(world, state, 1)
    assert state.pose[0].tolist() == [1, 2, 3]
    assert state.twist[0].tolist() == [7, 8, 9]


def expected_deviation(drive: str, u: np.ndarray) -> np.ndarray:
    if drive.startswith("omni"):
        return np.sqrt([0.03, 0.03, 0.03 if drive == "omni_angular" else 0.0])
    return np.array([math.sqrt(0.03) * abs(u[0]), math.sqrt(0.03) * abs(u[1]), 0.0])


@pytest.mark.parametrize(
    ("drive", "options"),
    [
        ("diff", core.DiffOptions(noise=True, alpha=[0.03, 0, 0, 0.03])),
        ("omni", core.OmniOptions(noise=True, alpha=[0.03, 0.03])),
        ("omni_angular", core.OmniAngularOptions(noise=True, alpha=[0.03, 0.03, 0.03])),
        (
            "steer",
            core.AckerOptions(noise=True, alpha=[0.03, 0, 0, 0.03], mode="steer", wheelbase=1.2, psi_max=math.inf),
        ),
    ],
)
def test_noise_is_drawn_by_step_and_object(drive: str, options) -> None:
    world, state = scene(robot(pose=[9, 9, 0]), robot(drive=options, extra=[0.2]), seeds=[77])
    for step in range(3):
        pose, psi = state.pose[1].copy(), state.extra[1, 0]
        u = np.array([0.7, -0.4, 0.2])
        command(state, [0, 0], u)
        core.advance(world, state, 1)
        z = oracle.normals(core.random_bits(77, 0, 0, core.STREAMS["motion"], 1, step))[:3]
        noisy = u + expected_deviation(drive, u) * z
        pose, psi, twist = oracle.move(drive, pose, psi, noisy, 0.1)
        np.testing.assert_allclose(state.pose[1], pose, atol=1e-12)
        np.testing.assert_allclose(state.twist[1], twist, atol=1e-12)
        assert state.control[1].tolist() == u.tolist()  # the executed command is without noise


@pytest.mark.parametrize("drive", DRIVES)
def test_follow_turns_a_wanted_velocity_into_motion(drive: str) -> None:
    world, state = scene(robot(drive=DRIVES[drive], pose=[0, 0, 2.5]), mode=1)
    wanted = np.array([0.5, -0.6])
    for _ in range(300):
        command(state, core.follow(world, state, 0, (wanted[0], wanted[1])))
        core.advance(world, state, 1)
    speed = np.linalg.norm(wanted)
    travel = state.twist[0, :2]
    assert np.linalg.norm(travel) == pytest.approx(speed, rel=0.01)
    assert travel @ wanted / speed**2 > math.cos(0.15)  # errors below 0.1 are left alone, steering acts a step late


@pytest.mark.parametrize("drive", DRIVES)
def test_follow_nothing_is_a_stop(drive: str) -> None:
    world, state = scene(robot(drive=DRIVES[drive], pose=[0, 0, 0.3]))
    assert core.follow(world, state, 0, (0.0, 0.0)) == (0.0, 0.0, 0.0)
