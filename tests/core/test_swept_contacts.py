"""`world.contacts: swept`: contacts within a step are collisions, and objects stop where they first touch."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import irsim._core as core
from tests.core.test_between_steps import BETWEEN, FAST, OMNI, WALLS
from tests.core.worlds import assert_identical, circle, command, everything, obstacle, rectangle, robot, scene

SWEPT = 1


def swept(*objects: core.ObjectSpec, **settings: Any) -> tuple[core.World, core.State]:
    world, state = scene(*objects, **settings)
    world.contacts = SWEPT
    return world, state


def kinds(state: core.State) -> list[str]:
    return [kind for kind, *_ in state.events(0)]


@pytest.mark.parametrize("wall", ["rectangle", "line"])
def test_a_robot_stops_where_it_touches_the_wall(wall: str) -> None:
    world, state = swept(robot(**FAST), WALLS[wall], history=True)
    near = {"rectangle": 0.99, "line": 1.0}[wall] - 0.2
    for step in range(4):
        command(state, [20.0])
        core.advance(world, state, 1)
        assert state.pose[0].tolist() == pytest.approx([near, 0.0, 0.0], abs=1e-8), step
        assert state.stopped.tolist() == state.collided.tolist() == [1, 1]
    assert kinds(state) == ["collision"]
    assert state.events(0)[0][4:] == pytest.approx((near + 0.2, 0.0), abs=1e-8)
    assert not state.between_steps.any()
    (only,) = state.trajectory(0).tolist()
    assert only[:3] == state.pose[0].tolist()


def test_the_twist_is_the_mean_of_the_step() -> None:
    world, state = swept(robot(**FAST), WALLS["line"])
    command(state, [20.0])
    core.advance(world, state, 1)
    assert state.twist[0, 0] * 0.1 == pytest.approx(0.8, abs=1e-8)


def test_both_stop_where_they_meet() -> None:
    world, state = swept(robot(**FAST), robot(**FAST, pose=[1.0, 0.0, np.pi]))
    command(state, [20.0], [10.0])
    core.advance(world, state, 1)
    assert state.pose[:, 0] == pytest.approx([0.4, 0.8], abs=1e-8)
    assert kinds(state) == ["collision"]


def test_who_stopped_is_in_the_way_of_others() -> None:
    """The first robot stops at the wall; the second would have followed it through."""
    world, state = swept(robot(**FAST), WALLS["line"], robot(**FAST, pose=[-1.0, 0.0, 0.0]))
    command(state, [20.0], [0.0], [20.0])
    core.advance(world, state, 1)
    assert state.pose[[0, 2], 0] == pytest.approx([0.8, 0.4], abs=1e-8)
    assert state.collision_pairs(0).tolist() == [[0, 1], [0, 2]]


def test_a_contact_that_another_one_prevents_does_not_count() -> None:
    world, state = swept(robot(**FAST), WALLS["line"], obstacle(pose=[1.5, 0.0, 0.0]))
    command(state, [20.0])
    core.advance(world, state, 1)
    assert state.collided.tolist() == [1, 1, 0]


@pytest.mark.parametrize("mode", [1, 2, 3])
def test_other_modes(mode: int) -> None:
    world, state = swept(robot(**FAST), robot(pose=[1.0, 0.1, 0.0], behavior=None, role=1, mass=np.inf), mode=mode)
    command(state, [20.0])
    core.advance(world, state, 1)
    if mode == 1:  # neither stops, and both are told
        assert state.pose[0, 0] == 2.0
        assert kinds(state) == ["collision", "passed_through"]
        assert state.collided.tolist() == [1, 1]
    if mode == 2:  # robots stop
        assert state.pose[0, 0] < 0.7
        assert state.stopped.tolist() == [1, 0]


def test_every_crossing_is_a_collision_of_its_own_with_its_own_time() -> None:
    world, state = swept(robot(**FAST), WALLS["line"], mode=1)
    for way in (20.0, -20.0, 20.0):
        command(state, [way])
        core.advance(world, state, 1)
    assert kinds(state) == ["collision", "passed_through"] * 3
    first, second, third = (state.moments(0)[k][0] for k in (0, 2, 4))
    assert first == third == pytest.approx(0.4, abs=1e-8)  # 0.8 m of 2 m
    assert second == pytest.approx(0.4, abs=1e-8)


def test_a_robot_that_is_freed_goes_on() -> None:
    world, state = swept(robot(**FAST), robot(pose=[1.0, 0.0, 0.0], behavior=None))
    command(state, [20.0])
    core.advance(world, state, 2)
    assert state.stopped.tolist() == [1, 1]
    state.pose[1, 0] = 9.0
    core.advance(world, state, 1)
    assert state.stopped.tolist() == [0, 0]
    state.reset(np.ones(1, np.uint8), False)
    assert state.stopped.tolist() == [0, 0]


def crowd(copies: int, order: int = 1) -> tuple[core.World, core.State]:
    rng = np.random.default_rng(8)
    starts = rng.uniform(0, 4, (14, 2))
    starts = starts[[k for k in range(14) if k == 0 or min(np.hypot(*(starts[:k] - starts[k]).T)) > 0.5]]
    shapes = [circle(0.15), rectangle(0.4, 0.06)]
    objects = [
        robot(**OMNI, number=k, pose=[*place, float(rng.uniform(-3, 3))], parts=[shapes[k % 2]], extra=[])
        for k, place in enumerate(starts.tolist())
    ]
    objects.append(obstacle(number=len(objects), pose=[2.0, 2.0, 0.3], parts=[rectangle(3.0, 0.02)]))
    return swept(*objects[::order], seeds=range(copies))


def drive(world: core.World, state: core.State, copies: int, order: int = 1, threads: int = 1) -> None:
    rng = np.random.default_rng(5)
    count = state.pose.shape[0] // copies
    for _ in range(6):
        controls = rng.uniform(-8, 8, (count, 3))[::order]
        command(state, *np.tile(controls, (copies, 1)).tolist())
        core.advance(world, state, 1, threads=threads)


def test_batches_equal_single_worlds_on_any_number_of_threads() -> None:
    world, state = crowd(1)
    drive(world, state, 1)
    assert len(state.collision_pairs(0)) >= 3
    for threads in (1, 3):
        many, states = crowd(4)
        drive(many, states, 4, threads=threads)
        alone = everything(state)
        for name, values in everything(states).items():
            if name not in ("seed",):
                assert values.tobytes() == np.concatenate([alone[name]] * 4).tobytes(), name
    assert_identical(everything(state), everything(state))


def test_the_order_of_objects_does_not_matter() -> None:
    world, state = crowd(1)
    drive(world, state, 1)
    turned, other = crowd(1, -1)
    rng = np.random.default_rng(5)
    count = state.pose.shape[0]
    for _ in range(6):
        controls = rng.uniform(-8, 8, (count, 3))
        command(other, *controls[::-1].tolist())
        core.advance(turned, other, 1)
    assert other.pose[::-1] == pytest.approx(state.pose, abs=1e-6)
    assert other.stopped[::-1].tolist() == state.stopped.tolist()


def test_nothing_passes_through_anything() -> None:
    world, state = crowd(1)
    drive(world, state, 1)
    assert not [kind for kind in kinds(state) if kind in BETWEEN]
