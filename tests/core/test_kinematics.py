"""Limits and motion of every drive: Euler's law against plain NumPy, exact arcs against fine integration."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import strategies as st

import irsim._core as core
from tests.core import oracle
from tests.core.worlds import DRIVES, PI, apply, command, robot, scene
from tests.effort import for_all

NUMBER = st.floats(-3, 3)
THREE = st.lists(NUMBER, min_size=3, max_size=3)


@pytest.mark.parametrize("drive", DRIVES)
@for_all(
    40,
    x=NUMBER,
    y=NUMBER,
    theta=st.floats(-PI, PI),
    psi=st.floats(-0.9, 0.9),
    wanted=THREE,
    before=THREE,
    data=st.data(),
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
    apply(world, state, wanted)
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
    apply(world, state, [0.0, 0.0])
    assert state.control[0, 0] == 1.0  # 4.9 is the lower end of the window, vel_max the upper


def test_steering_is_limited_by_psi_max() -> None:
    drive = core.AckerOptions(noise=False, alpha=[0.0] * 4, mode="steer", wheelbase=1.0, psi_max=0.3)
    world, state = scene(robot(drive=drive))
    apply(world, state, [1.0, -0.8])
    assert state.control[0, 1] == -0.3
    assert state.extra[0, 0] == -0.3


@pytest.mark.parametrize(("theta", "rate"), [(3.1, 1.0), (-3.1, -1.0), (0.5, 1.0)])
def test_heading_stays_in_its_interval(theta: float, rate: float) -> None:
    world, state = scene(robot(pose=[0, 0, theta], angle_range=[0.0, 2 * PI]))
    apply(world, state, [0.0, rate])
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
        ("diff", core.DiffOptions(noise=True, alpha=[0.03, 0, 0, 0.03], track=0.3)),
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
        apply(world, state, [0, 0], u)
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
        apply(world, state, core.follow(world, state, 0, (wanted[0], wanted[1])))
    speed = np.linalg.norm(wanted)
    travel = state.twist[0, :2]
    assert np.linalg.norm(travel) == pytest.approx(speed, rel=0.01)
    assert travel @ wanted / speed**2 > math.cos(0.15)  # errors below 0.1 are left alone, steering acts a step late


@pytest.mark.parametrize("drive", DRIVES)
def test_follow_nothing_is_a_stop(drive: str) -> None:
    world, state = scene(robot(drive=DRIVES[drive], pose=[0, 0, 0.3]))
    assert core.follow(world, state, 0, (0.0, 0.0)) == (0.0, 0.0, 0.0)


EXACT = 1
TURNING = ["diff", "omni_angular", "steer", "angular"]
SPEED = st.floats(-2, 2)


def exact_world(*specs: core.ObjectSpec, step_time: float = 0.1, **options):
    world, state = scene(*specs, step_time=step_time, **options)
    world.integration = EXACT
    return world, state


def fine(drive: str, pose: np.ndarray, psi: float, u: np.ndarray, dt: float, steps: int = 400) -> np.ndarray:
    """Pose after a period of constant control and steering: fourth-order Runge-Kutta in small steps."""

    def rates(p: np.ndarray) -> np.ndarray:
        return oracle.move(drive, p, psi, u, 0.0)[2]

    h, at = dt / steps, pose.copy()
    for _ in range(steps):
        a = rates(at)
        b = rates(at + h / 2 * a)
        c = rates(at + h / 2 * b)
        d = rates(at + h * c)
        at = at + h / 6 * (a + 2 * b + 2 * c + d)
    return at


def stepped(drive: str, pose: np.ndarray, psi: float, u: np.ndarray, dt: float, steps: int = 1) -> np.ndarray:
    """Pose after some steps of exact motion with the same control."""
    state, extra = [*pose, psi], psi
    for _ in range(steps):
        state[3] = extra
        state, _ = core.drive_step(DRIVES[drive], state, list(u), dt, EXACT)
    return np.array(state[:3])


def same_pose(a: np.ndarray, b: np.ndarray, tolerance: float) -> None:
    np.testing.assert_allclose(a[:2], b[:2], atol=tolerance)
    assert abs(math.remainder(a[2] - b[2], 2 * PI)) < tolerance


@pytest.mark.parametrize("drive", DRIVES)
@for_all(
    15,
    theta=st.floats(-PI, PI),
    psi=st.floats(-0.9, 0.9),
    u=st.lists(SPEED, min_size=3, max_size=3),
    dt=st.floats(0.01, 2),
)
def test_a_step_is_the_limit_of_fine_steps(drive: str, theta: float, psi: float, u: list[float], dt: float) -> None:
    world, state = exact_world(
        robot(drive=DRIVES[drive], pose=[1, 2, theta], extra=[psi], vel_min=[-2] * 3, vel_max=[2] * 3), step_time=dt
    )
    apply(world, state, u)
    expected = fine(drive, np.array([1, 2, theta]), psi, np.array(u), dt)
    same_pose(state.pose[0], expected, 1e-7)
    _, psi_after, twist = oracle.move(drive, np.array([1, 2, theta]), psi, np.array(u), dt)
    np.testing.assert_allclose(state.twist[0], twist, atol=1e-12)  # the start of the step counts, as under Euler
    if drive in ("steer", "angular"):
        assert state.extra[0, 0] == pytest.approx(psi_after, abs=1e-12)


@pytest.mark.parametrize("drive", TURNING)
@for_all(
    25,
    theta=st.floats(-PI, PI),
    psi=st.floats(-0.9, 0.9),
    u=st.lists(SPEED, min_size=3, max_size=3),
    dt=st.floats(0.01, 3),
    parts=st.integers(2, 50),
)
def test_motion_with_a_constant_control_does_not_depend_on_the_step(
    drive: str, theta: float, psi: float, u: list[float], dt: float, parts: int
) -> None:
    control = np.array([u[0], psi if drive == "steer" else 0.0 if drive == "angular" else u[1], u[2]])
    at = np.array([0.3, -0.7, theta])
    same_pose(stepped(drive, at, psi, control, dt), stepped(drive, at, psi, control, dt / parts, parts), 1e-12)


@pytest.mark.parametrize("rate", [0.0, 1e-300, 1e-12, 1e-8, 1e-5, 0.0499, 0.05, 0.0501, 0.1, 1e-3])
def test_small_yaw_rates_lose_no_digit(rate: float) -> None:
    after, _ = core.drive_step(DRIVES["diff"], [0, 0, 0], [1.0, rate], 0.1, EXACT)
    turn = rate * 0.1
    lateral = 0.1 * (turn / 2) * (1 - turn**2 / 12 + turn**4 / 360)  # series of (1 - cos) / turn
    forward = 0.1 * (1 - turn**2 / 6 + turn**4 / 120)
    assert after[0] == pytest.approx(forward, rel=3e-16)
    assert after[1] == pytest.approx(lateral, rel=1e-15, abs=0)


def test_straight_motion_is_that_of_euler_to_the_bit() -> None:
    for drive in DRIVES:
        for theta in (0.3, 1.9, -2.7):
            state, control = [0.1, 0.2, theta, 0.0], [0.7, 0.0 if drive != "omni" else -0.4, 0.0]
            assert core.drive_step(DRIVES[drive], state, control, 0.1, EXACT) == core.drive_step(
                DRIVES[drive], state, control, 0.1
            )


def test_a_circle_closes_exactly_and_euler_is_as_far_off_as_stated() -> None:
    off = {}
    for dt in (0.1, 1.0):
        end, state = (1.25 * math.sin(3.2), 1.25 * (1 - math.cos(3.2))), [0.0, 0.0, 0.0]
        for _ in range(round(4 / dt)):
            state, _ = core.drive_step(DRIVES["diff"], state, [1.0, 0.8], dt)
        off[dt] = math.dist(state[:2], end)
        same_pose(
            stepped("diff", np.zeros(3), 0.0, np.array([1.0, 0.8, 0]), dt, round(4 / dt)), np.array([*end, 3.2]), 1e-13
        )
    assert off[0.1] == pytest.approx(0.10, abs=0.005)
    assert off[1.0] == pytest.approx(1.0, abs=0.05)


def test_noise_bends_the_arc() -> None:
    options = core.DiffOptions(noise=True, alpha=[0.03, 0, 0, 0.03], track=0.3)
    world, state = exact_world(robot(drive=options), seeds=[5])
    apply(world, state, [0.8, 0.6])
    u = state.twist[0]
    speed = math.hypot(u[0], u[1])
    assert abs(speed - 0.8) > 1e-6
    assert abs(u[2] - 0.6) > 1e-6
    same_pose(state.pose[0], stepped("diff", np.zeros(3), 0.0, np.array([speed, u[2], 0.0]), 0.1), 1e-14)
