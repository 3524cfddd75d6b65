"""Bodies in contact, whatever their places and masses: momentum, friction cones, pieces of polygons."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume
from hypothesis import strategies as st

import irsim._core as core
from tests.core import oracle
from tests.core.test_contact import CONTACT, DT, SLOP, body, contacts, driver
from tests.core.worlds import DRIVES, apply, circle, obstacle, polygon, rectangle, scene
from tests.effort import for_all

# what every contact obeys ---------------------------------------------------------------------------------------------
ANGLE = st.floats(-math.pi, math.pi)


def flat(angle: float, friction: float = 0.0):
    """A wall that the unit-radius-0.2 disc at the origin rests against; its normal points to the disc at `angle`."""
    x, y = -0.300005 * math.cos(angle), -0.300005 * math.sin(angle)
    return obstacle(parts=[rectangle(0.2, 1.0)], pose=[x, y, angle], friction=friction)


def unit(angle: float) -> np.ndarray:
    return np.array([math.cos(angle), math.sin(angle)])


@for_all(60, st.lists(ANGLE, min_size=0, max_size=3), ANGLE, st.floats(0.2, 5.0))
def test_a_body_gives_way_past_what_blocks_it_most(walls: list[float], push: float, mass: float) -> None:
    depth = 0.02
    pusher = body(parts=[circle(0.2)], pose=[*(-(0.4 - depth) * unit(push)), 0.0], friction=0.0)
    disc = body(parts=[circle(0.2)], friction=0.0, mass=mass)
    world, state = scene(disc, pusher, *[flat(angle) for angle in walls], mode=CONTACT)
    pairs = [*[(0, 2 + k) for k in range(len(walls))], (0, 1)]
    core.contact_step(world, state, 0, pairs, 1, SLOP, DT)
    free = unit(push)
    against = [float(unit(angle) @ free) for angle in walls]
    if against and min(against) < -1e-9:
        free = free - min(against) * unit(walls[int(np.argmin(against))])
    share = max(0.0, float(free @ unit(push))) / mass
    scale = (depth + SLOP) / (1.0 + share)
    assert state.pose[0, :2] == pytest.approx(free / mass * scale, abs=1e-9)
    assert state.pose[1, :2] == pytest.approx(-(0.4 - depth + scale) * unit(push), abs=1e-9)


@for_all(60, st.floats(-1.4, 1.4), st.floats(0.0, 1.5), st.floats(0.0, 1.5))
def test_a_pressed_body_sticks_inside_the_friction_cone_and_slides_outside(
    angle: float, ground: float, wall: float
) -> None:
    mean = (ground + wall) / 2
    assume(abs(math.tan(abs(angle)) - mean) > 1e-6)
    depth = 0.02
    pusher = body(parts=[circle(0.2)], pose=[*(-(0.4 - depth) * unit(angle)), 0.0], friction=0.0)
    disc = body(parts=[circle(0.2)], friction=ground)
    world, state = scene(disc, pusher, flat(math.pi, wall), mode=CONTACT)
    core.contact_step(world, state, 0, [(0, 2), (0, 1)], 1, SLOP, DT)
    slides = math.tan(abs(angle)) > mean
    scale = (depth + SLOP) / (1.0 + math.sin(angle) ** 2)
    assert state.pose[0, :2].tolist() == pytest.approx([0.0, math.sin(angle) * scale if slides else 0.0], abs=1e-9)


@for_all(60, st.integers(0, 10_000))
def test_contacts_conserve_momentum_and_angular_momentum(seed: int) -> None:
    rng = np.random.default_rng(seed)
    parts = [[circle(0.2)], [rectangle(0.5, 0.3)], [polygon((-0.2, -0.2), (0.3, -0.1), (0.0, 0.25))]]
    bodies = [
        body(
            parts=parts[int(rng.integers(3))],
            pose=[0.2 * k, rng.uniform(-0.1, 0.1), rng.uniform(-3, 3)],
            mass=float(rng.uniform(0.1, 10.0)),
            friction=0.0,
        )
        for k in range(2)
    ]
    world, state = scene(*bodies, mode=CONTACT)
    assume(oracle.shape_of(state, 0).intersection(oracle.shape_of(state, 1)).area > 0)  # apart in 4 of the 10,001 draws
    centres = np.array([_centroid(state, row) for row in range(2)])
    core.contact_step(world, state, 0, [(0, 1)], 1, SLOP, DT)
    ((_, _, nx, ny, depth, *_),) = contacts(state)
    mass = np.array([1 / state.body(row)[0] for row in range(2)])
    inertia = np.array([1 / state.body(row)[1] for row in range(2)])
    momentum = mass[:, None] * state.control[:, :2]
    assert depth > 0
    assert np.abs(momentum).max() > 0
    assert momentum.sum(axis=0) == pytest.approx(0.0, abs=1e-9)
    assert abs(momentum[0] @ [-ny, nx]) < 1e-9, "along the normal"
    spin = np.sum(inertia * state.control[:, 2]) + np.sum(
        centres[:, 0] * momentum[:, 1] - centres[:, 1] * momentum[:, 0]
    )
    assert spin == pytest.approx(0.0, abs=1e-7 + 1e-6 * np.abs(momentum).max() / DT)


def _centroid(state: core.State, row: int) -> np.ndarray:
    *_, x, y = state.body(row)
    c, s = math.cos(state.pose[row, 2]), math.sin(state.pose[row, 2])
    return state.pose[row, :2] + [c * x - s * y, s * x + c * y]


@for_all(20, st.floats(0.5, 5.0), st.floats(0.1, 0.9), st.floats(0.2, 1.0), st.sampled_from(["diff", "omni"]))
def test_a_box_pushed_at_its_middle_stays_in_front(mass: float, friction: float, speed: float, name: str) -> None:
    box = body(parts=[rectangle(0.5, 0.5)], pose=[0.46, 0.0, 0], mass=mass, friction=friction)
    pusher = driver(parts=[rectangle(0.4, 0.4)], drive=DRIVES[name], mass=5.0, control=[speed, 0.0, 0.0])
    world, state = scene(pusher, box, mode=CONTACT)
    apply(world, state, [speed, 0.0], steps=60)
    assert state.pose[1, 1:].tolist() == pytest.approx([0.0, 0.0], abs=1e-6)
    assert state.pose[1, 0] - state.pose[0, 0] == pytest.approx(0.45 + SLOP, abs=1e-6)
    assert state.pose[0, 0] == pytest.approx(60 * speed * DT, abs=1e-9)


def test_contact_step_keeps_to_its_sweeps_and_to_the_order_of_its_pairs() -> None:
    def moved(*pairs: tuple[int, int], sweeps: int = 1) -> list[float]:
        row = [body(parts=[circle(0.2)], pose=[0.39 * k, 0, 0], friction=0.0) for k in range(3)]
        world, state = scene(*row, mode=CONTACT)
        core.contact_step(world, state, 0, list(pairs), sweeps, 0.0, DT)
        return (state.pose[:, 0] - [0, 0.39, 0.78]).tolist()

    assert moved((0, 1), (1, 2)) == pytest.approx([-0.005, -0.0025, 0.0075])
    assert moved((1, 2), (0, 1)) == pytest.approx([-0.0075, 0.0025, 0.005])
    assert moved((2, 1), (0, 1), (1, 2)) == pytest.approx([-0.0075, 0.0025, 0.005]), "each pair once"
    assert moved((0, 1), (1, 2), sweeps=200) == pytest.approx([-0.01, 0.0, 0.01], abs=1e-9)


# geometry ------------------------------------------------------------------------------------------------------------
def area(ring: np.ndarray) -> float:
    x, y = ring.T
    return float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2


@pytest.mark.parametrize("turned", [False, True])
def test_pieces_of_a_polygon_are_convex_and_cover_it(turned: bool) -> None:
    outline = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (2, 3), (0, 4), (-1, 1)]
    spec = body(parts=[polygon(*(outline[::-1] if turned else outline))])
    _, state = scene(spec, mode=CONTACT)
    pieces = state.pieces(0)
    assert all(area(piece) > 0 for piece in pieces)
    assert sum(area(piece) for piece in pieces) == pytest.approx(area(np.array(outline, float)))


def test_mass_properties_are_exact() -> None:
    triangle = [(-0.2, -0.3), (0.5, -0.1), (-0.2, 0.4)]
    shapes = [circle(0.3, (0.1, 0.2)), rectangle(0.6, 0.4), polygon(*triangle)]
    _, state = scene(*[body(parts=[shape], mass=2.0) for shape in shapes], mode=CONTACT)
    p = np.array(triangle)
    sides = sum(np.sum((p[k] - p[k - 1]) ** 2) for k in range(3))
    for row, (gyration2, centre) in enumerate(
        [(0.3**2 / 2, (0.1, 0.2)), ((0.6**2 + 0.4**2) / 12, (0, 0)), (sides / 36, p.mean(axis=0))]
    ):
        w, i, per_mass, x, y = state.body(row)
        assert w == 0.5
        assert per_mass == pytest.approx(gyration2)
        assert i == pytest.approx(1 / (2.0 * gyration2))
        assert (x, y) == pytest.approx(tuple(centre), abs=1e-12)


# anything ------------------------------------------------------------------------------------------------------------


@for_all(25, st.integers(0, 10_000), st.sampled_from(["diff", "omni", "omni_angular", "steer"]))
def test_whatever_is_pushed_stays_apart_and_the_same_every_time(seed: int, name: str) -> None:
    rng = np.random.default_rng(seed)
    shapes = [circle(0.2), rectangle(0.4, 0.3), polygon((-0.2, -0.2), (0.25, -0.1), (0.0, 0.25))]
    bodies = [
        body(
            parts=[shapes[int(rng.integers(3))]],
            pose=[1.0 + 0.75 * (k % 3), 0.75 * (k // 3 - 1) + rng.uniform(-0.1, 0.1), rng.uniform(-3, 3)],
            mass=float(rng.uniform(0.3, 3.0)),
            friction=float(rng.uniform(0.1, 0.6)),
        )
        for k in range(9)
    ]
    walls = [
        obstacle(parts=[rectangle(0.2, 4.0)], pose=[3.2, 0, 0], friction=0.5),
        obstacle(parts=[rectangle(3.0, 0.2)], pose=[2.0, 1.4, 0], friction=0.5),
    ]
    second = driver(drive=DRIVES["omni"], pose=[0.0, 0.9, -0.3], mass=float(rng.uniform(0.5, 20.0)))
    objects = [driver(drive=DRIVES[name], extra=[0.0]), second, *bodies, *walls]

    def run() -> core.State:
        world, state = scene(*objects, mode=CONTACT)
        apply(world, state, [0.8, 0.05, 0.02][: 3 if name == "omni_angular" else 2], [0.6, 0.0], steps=40)
        return state

    state = run()
    assert np.isfinite(state.pose).all()
    placed = [oracle.shape_of(state, row) for row in range(len(objects))]
    for i, one in enumerate(placed[: -len(walls)]):
        for other in [*placed[:i], *placed[-len(walls) :]]:
            assert not one.buffer(-1e-3).intersects(other), (i, seed)
    assert state.pose.tolist() == run().pose.tolist()
