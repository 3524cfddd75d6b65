"""Rigid contacts against closed forms: who moves, how far, how fast."""

from __future__ import annotations

import math

import numpy as np
import pytest

import irsim._core as core
from tests.core.worlds import DRIVES, advanced, apply, circle, line, obstacle, rectangle, robot, scene

CONTACT = 3
G = 9.81
SLOP = 1e-6
DT = 0.1


def body(**options):
    """Something without a drive that can be pushed."""
    return obstacle(**{"static": False, "mass": 1.0, **options})


def driver(**options):
    return robot(**{"mass": 5.0, "friction": 1.0, "control": [1.0, 0.0, 0.0], "behavior": None, **options})


def contacts(state, world: int = 0):
    return state.contacts(world)


# friction and drives -------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("friction", [0.1, 0.5])
def test_a_sliding_body_comes_to_rest_by_friction(friction: float) -> None:
    dt, speed = 1e-4, 1.0
    state = advanced(
        1 + round(speed / (friction * G * dt)),
        body(friction=friction, control=[speed, 0, 0]),
        mode=CONTACT,
        step_time=dt,
    )
    decrement = friction * G * dt
    assert state.pose[0, 0] == pytest.approx(speed**2 / (2 * friction * G) - speed * dt / 2, abs=decrement * dt)
    assert state.pose[0, 0] == pytest.approx(speed**2 / (2 * friction * G), abs=1e-4)
    assert state.control[0].tolist() == [0, 0, 0]


def test_a_spinning_body_comes_to_rest_by_friction() -> None:
    world, state = scene(body(parts=[circle(0.2)], control=[0, 0, 1.5], friction=0.1), mode=CONTACT, step_time=0.01)
    gyration = 0.2 / math.sqrt(2)
    less = 0.1 * G * 0.01 / gyration
    core.advance(world, state, 3)
    assert state.control[0, 2] == pytest.approx(1.5 - 3 * less, abs=1e-12)
    assert state.pose[0, 2] == pytest.approx(0.01 * (3 * 1.5 - 6 * less), abs=1e-12)


def test_bodies_without_a_drive_slide_in_every_mode_until_something_stops_them() -> None:
    state = advanced(1, body(control=[1, 0, 0]), mode=0)
    assert state.control[0, 0] == pytest.approx(1 - 0.5 * G * DT)


@pytest.mark.parametrize("name", ["diff", "omni", "omni_angular", "steer"])
def test_drives_answer_with_their_lag(name: str) -> None:
    tau, wanted = 0.3, np.array([0.8, 0.3, 0.2])
    spec = driver(drive=DRIVES[name], control=[0, 0, 0], friction=10.0, tau=tau, extra=[0.0])
    world, state = scene(spec, mode=CONTACT)
    rows = 3 if name == "omni_angular" else 2
    for step in range(1, 6):
        apply(world, state, wanted[:rows])
        expected = wanted[:rows] * (1 - (1 - DT / tau) ** step)
        assert state.control[0, :rows] == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("name", ["diff", "omni"])
def test_wheels_grip_with_their_friction_only(name: str) -> None:
    world, state = scene(driver(drive=DRIVES[name], control=[0, 0, 0], friction=0.1), mode=CONTACT)
    apply(world, state, [1.0, 0.5], steps=2)
    most = 0.1 * G * DT
    if name == "diff":
        assert state.control[0, :2].tolist() == pytest.approx([2 * most, 0.5])
    else:
        assert np.hypot(*state.control[0, :2]) == pytest.approx(2 * most)
        assert state.control[0, 1] / state.control[0, 0] == pytest.approx(0.5)


# pushing -------------------------------------------------------------------------------------------------------------
def test_a_driver_with_enough_traction_keeps_its_speed() -> None:
    box = body(parts=[rectangle(0.4, 0.4)], pose=[0.45, 0, 0])
    world, state = scene(driver(mass=0.6), box, mode=CONTACT)
    apply(world, state, [1.0, 0.0], steps=20)
    assert state.pose[0].tolist() == pytest.approx([2.0, 0, 0], abs=1e-12)
    assert state.control[0].tolist() == pytest.approx([1, 0, 0], abs=1e-12)
    assert state.pose[1].tolist() == pytest.approx([2.0 + 0.4 + SLOP, 0, 0], abs=1e-9)
    assert state.control[1].tolist() == pytest.approx([1, 0, 0], abs=1e-6)


def test_a_driver_with_too_little_traction_stalls() -> None:
    box = body(parts=[rectangle(0.4, 0.4)], pose=[0.45, 0, 0])
    world, state = scene(driver(mass=0.4), box, mode=CONTACT)
    apply(world, state, [1.0, 0.0], steps=20)
    assert state.pose[:, 0].tolist() == pytest.approx([0.05 - SLOP, 0.45], abs=1e-12)
    assert state.control[0, 0] == pytest.approx(0.0, abs=1e-9)
    ((_, _, *_, force),) = contacts(state)
    assert force == pytest.approx(0.4 * G)


@pytest.mark.parametrize(("mass", "moves"), [(1.49, False), (1.51, True)])
def test_traction_must_overcome_everything_ahead(mass: float, moves: bool) -> None:
    boxes = [body(parts=[rectangle(0.4, 0.4)], pose=[0.4 + 0.4 * k, 0, 0]) for k in range(3)]
    world, state = scene(driver(mass=mass), *boxes, mode=CONTACT)
    apply(world, state, [1.0, 0.0], steps=5)
    assert bool(state.pose[0, 0] > 0.4) == moves


def test_a_push_off_the_centre_turns_the_box() -> None:
    box = body(parts=[rectangle(0.4, 0.4)], pose=[0.45, -1e-3, 0])
    world, state = scene(driver(), box, mode=CONTACT)
    apply(world, state, [1.0, 0.0])
    depth, arm, inertia = 0.05 + SLOP, 1e-3, (0.4**2 + 0.4**2) / 12
    scale = depth / (1 + arm**2 / inertia)
    assert state.pose[1, 2] == pytest.approx(-arm / inertia * scale, rel=2e-3)
    assert state.pose[1, 0] == pytest.approx(0.45 + depth, rel=1e-4)


def test_shares_of_two_bodies_are_those_of_momentum() -> None:
    one = body(mass=1.0, friction=0.0, control=[1, 0, 0], parts=[circle(0.2)])
    two = body(mass=3.0, friction=0.0, parts=[circle(0.2)], pose=[0.45, 0, 0])
    world, state = scene(one, two, mode=CONTACT)
    core.advance(world, state, 1)
    depth = 0.05 + SLOP
    assert state.pose[:, 0].tolist() == pytest.approx([0.1 - depth * 0.75, 0.45 + depth * 0.25], abs=1e-12)
    core.advance(world, state, 20)
    momentum = state.control[0, 0] * 1.0 + state.control[1, 0] * 3.0
    assert momentum == pytest.approx(1.0, abs=1e-9)
    assert state.control[:, 0].tolist() == pytest.approx([0.25, 0.25], abs=1e-5)


@pytest.mark.parametrize("e", [0.0, 0.4, 1.0])
def test_equal_discs_part_with_their_restitution(e: float) -> None:
    one = body(friction=0.0, control=[1, 0, 0], restitution=e)
    two = body(friction=0.0, pose=[0.45, 0, 0], restitution=e)
    state = advanced(5, one, two, mode=CONTACT)
    if e > 0.0:
        assert state.control[:, 0].tolist() == pytest.approx([(1 - e) / 2, (1 + e) / 2], abs=1e-6)
    else:
        assert state.control[:, 0].tolist() == pytest.approx([0.5, 0.5], abs=1e-5)


def test_a_body_that_cannot_yield_stops_the_strongest_driver() -> None:
    wall = obstacle(parts=[rectangle(0.2, 2.0)], pose=[0.8, 0, 0])
    box = body(parts=[rectangle(0.4, 0.4)], pose=[0.45, 0, 0])
    world, state = scene(driver(), box, wall, mode=CONTACT)
    apply(world, state, [1.0, 0.0], steps=20)
    assert state.pose[1, 0] == pytest.approx(0.5, abs=2e-5)
    assert state.pose[0, 0] == pytest.approx(0.1, abs=2e-5)
    assert not state.stopped.any()
    assert not state.collided.any()


@pytest.mark.parametrize(("friction", "slides"), [(0.3, True), (3.0, False)])
def test_the_friction_cone_decides_whether_a_disc_slides_along_a_wall(friction: float, slides: bool) -> None:
    wall = obstacle(parts=[line((-5, 5), (5, -5))], pose=[1.0, 0.0, 0.0], friction=friction)
    disc = body(parts=[circle(0.2)], pose=[0.45, 0, 0], friction=friction)
    world, state = scene(driver(mass=1000.0), disc, wall, mode=CONTACT)
    apply(world, state, [1.0, 0.0], steps=5)  # there
    before = state.pose[1, 1]
    apply(world, state, [1.0, 0.0], steps=3)
    along = abs(state.pose[1, 1] - before)
    assert along > 1e-3 if slides else along < 1e-6


def test_unobstructed_and_other_modes_do_not_push() -> None:
    def run(mode: int, **options) -> float:
        world, state = scene(driver(), body(pose=[0.45, 0, 0], **options), mode=mode)
        apply(world, state, [1.0, 0.0], steps=3)
        return float(state.pose[1, 0])

    assert run(CONTACT) > 0.5
    assert run(CONTACT, unobstructed=True) == 0.45
    assert run(1) == 0.45


# times and records ---------------------------------------------------------------------------------------------------
def test_contacts_are_recorded_and_timed() -> None:
    world, state = scene(driver(), body(pose=[0.55, 0, 0]), mode=CONTACT)
    apply(world, state, [1.0, 0.0])
    assert contacts(state) == []
    assert state.air_time.tolist() == pytest.approx([DT, DT])
    apply(world, state, [1.0, 0.0])
    ((a, b, nx, ny, depth, x, y, force),) = contacts(state)
    assert (a, b, nx, ny) == (0, 1, -1.0, 0.0)
    assert (depth, x, y) == pytest.approx((0.05 + SLOP, 0.375, 0.0))
    assert force == pytest.approx(depth / DT**2)
    assert state.touching.tolist() == [1, 1]
    apply(world, state, [1.0, 0.0])
    assert state.touching.tolist() == [3, 3]
    assert state.contact_time.tolist() == pytest.approx([2 * DT, 2 * DT])
    apply(world, state, [-1.0, 0.0])
    apply(world, state, [-1.0, 0.0])
    assert (state.touching[0] & 1) == 0
    state.reset(np.ones(1, np.uint8), False)
    assert contacts(state) == []
    assert state.contact_time.tolist() == [0, 0]
