"""Batches, threads, rollouts, phases: the same numbers, bit for bit."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import irsim._core as core
from tests.core.test_reset import NOISY, crowd
from tests.core.test_shapes import random_polygon
from tests.core.worlds import (
    DRIVES,
    PLAIN,
    assert_identical,
    command,
    everything,
    fmcw,
    kernel,
    lidar,
    obstacle,
    rectangle,
    robot,
    rows_of,
    scene,
)

pytestmark = pytest.mark.every_python


def movers(name: str, seeds: Sequence[int]) -> tuple[core.World, core.State]:
    """Objects of every drive that run a behavior among two things."""
    rng = np.random.default_rng(5)
    noise = {"noise": 1e-4} if name == "avocado" else {}
    places, goals, headings = rng.uniform(0, 9, (50, 2)), rng.uniform(0, 9, (50, 2)), rng.uniform(-3, 3, 50)
    objects = [
        robot(drive=drive, behavior=kernel(name, **noise), grouped=name == "orca", pose=[*place, heading], goals=[goal])
        for place, goal, heading, drive in zip(places, goals.tolist(), headings, 10 * [*DRIVES.values()], strict=True)
    ]
    things = [obstacle(parts=[rectangle(1.0, 2.0)], pose=[6.0, 6.0, 0.5]), obstacle(pose=[3.0, 6.0, 0.0])]
    return scene(*objects, *things, seeds=seeds, mode=1)


def pushed(seeds: Sequence[int]) -> tuple[core.World, core.State]:
    """A robot that pushes bodies whose shapes are drawn."""
    part = random_polygon(center_range=[0] * 4, avg_radius_range=[0.2, 0.4], spikeyness_range=[0, 0.5])
    bodies = [obstacle(static=False, mass=1.0, parts=[part], pose=[0.7 * k, 0.2 * k, k]) for k in range(1, 5)]
    return scene(robot(drive=NOISY, mass=5.0, friction=1.0, goals=[[9, 1]]), *bodies, seeds=seeds, mode=3)


def fast(seeds: Sequence[int]) -> tuple[core.World, core.State]:
    """Robots that drive arcs so fast that they would pass through a wall within a step."""
    top = {"drive": NOISY, "vel_max": [20.0] * 3, "vel_min": [-20.0] * 3, "loop": True}
    robots = [robot(**top, pose=[0, 2 * k, 0.3 * k], goals=[[9 + k, 8 - 2 * k]]) for k in range(4)]
    world, state = scene(*robots, obstacle(pose=[5, 5, 0], parts=[rectangle(0.02, 8.0)]), seeds=seeds)
    world.contacts = world.integration = 1
    return world, state


def scanning(seeds: Sequence[int]) -> tuple[core.World, core.State]:
    """Robots of every drive that measure ranges and velocities with noise."""
    sensors = [fmcw(30, noise=True, velocity_noise_std=0.2), lidar(7, has_velocity=True)]
    drives = enumerate(DRIVES.values())
    robots = [robot(drive=d, pose=[k, 0, 0], goals=[[k, 5]], loop=True, sensors=sensors) for k, d in drives]
    return scene(*robots, seeds=seeds)


SPREADS = {"speeds": [0], "attempts": 1000, "position": 0.3, "heading": 0.4, "speed": 0.2, "delay": 1.5}
SCENES: dict[str, Callable[[Sequence[int]], tuple[core.World, core.State]]] = {
    **{name: partial(movers, name) for name in PLAIN},
    "perturbed": partial(crowd, perturbations=[core.Perturbation(object=k, **SPREADS) for k in (1, 2, 3)]),
    "pushed": pushed,
    "fast": fast,
    "scanning": scanning,
}


def assert_alike(build: Any, seeds: Sequence[int], threads: int, steps: int, until_done: bool = False) -> core.State:
    """Worlds of a batch are those worlds alone, also after some of them have begun the next scene."""
    world, state = build(seeds)
    core.advance(world, state, steps, threads=threads, until_done=until_done)
    state.reset(np.arange(len(seeds)).astype(np.uint8) % 2, True)
    core.advance(world, state, steps, threads=threads, until_done=until_done)
    batch = everything(state)
    for w, seed in enumerate(seeds):
        world, alone = build([seed])
        core.advance(world, alone, steps, until_done=until_done)
        alone.reset(np.array([w % 2], np.uint8), True)
        core.advance(world, alone, steps, until_done=until_done)
        assert_identical(rows_of(batch, w, len(seeds)), everything(alone))
        assert state.events(w) == alone.events(0)
        assert state.collision_pairs(w).tolist() == alone.collision_pairs(0).tolist()
    return state


@pytest.mark.parametrize("name", SCENES)
def test_a_world_of_a_batch_is_that_world_alone(name: str) -> None:
    state = assert_alike(SCENES[name], (4, 5, 6), threads=3, steps=20)
    first, _, third = np.split(everything(state)["ranges" if name == "scanning" else "pose"], 3)
    assert np.array_equal(first, third) == (name in ("orca", "rvo", "sfm")), "draws follow the seed"


@settings(max_examples=15)
@given(
    seeds=st.lists(st.integers(0, 2**64 - 1), min_size=1, max_size=7),
    threads=st.integers(1, 5),
    steps=st.integers(0, 30),
    until_done=st.booleans(),
)
def test_worlds_with_all_that_draws_are_alike(seeds, threads: int, steps: int, until_done: bool) -> None:
    assert_alike(crowd, seeds, threads, steps, until_done)


@pytest.mark.parametrize("name", PLAIN)
def test_deciding_again_and_a_reset_change_nothing(name: str) -> None:
    world, state = movers(name, [4])
    core.advance(world, state, 20)
    first = state.pose.copy()
    core.decide(world, state)
    once = everything(state), [state.opinions(row) for row in range(50)]
    core.decide_row(world, state, 2)
    core.decide(world, state)
    assert_identical(everything(state), once[0])
    assert [state.opinions(row) for row in range(50)] == once[1]
    assert any(once[1]) == (name == "avocado")
    state.reseed(np.array([4], np.uint64), np.ones(1, np.uint8))
    state.reset(np.ones(1, np.uint8), False)
    assert not any(state.opinions(row) for row in range(50))
    core.advance(world, state, 20)
    np.testing.assert_array_equal(state.pose, first)


@pytest.mark.parametrize("ranges", [False, True])
def test_a_rollout_is_repeated_advance(ranges: bool) -> None:
    world, state = crowd([4, 5, 6])
    trace = core.rollout(world, state, 25, threads=2, ranges=ranges)
    other_world, other = crowd([4, 5, 6])
    for t in range(25):
        core.advance(other_world, other, 1)
        for name in ("pose", "control", "arrived", "collided"):
            np.testing.assert_array_equal(getattr(trace, name)[t], getattr(other, name))
        if ranges:
            np.testing.assert_array_equal(trace.ranges[t], other.ranges)
    assert_identical(everything(state), everything(other))
    assert trace.pose.shape == (25, 21, 3)
    assert trace.steps.tolist() == [25] * 3
    assert trace.ranges.shape == (25 if ranges else 0, 60)


def test_worlds_rest_when_their_robots_are_done() -> None:
    world, state = scene(robot(goals=[[0.35, 0]]), seeds=[0, 1])
    state.set_goals(1, [[0.95, 0]], True)
    trace = core.rollout(world, state, 100, until_done=True)
    assert trace.steps.tolist() == [3, 9]
    assert trace.pose.shape == (9, 2, 3)
    np.testing.assert_array_equal(trace.pose[3:, 0], trace.pose[[2] * 6, 0])
    assert trace.arrived[-1].tolist() == [1, 1]
    assert core.advance(world, state, 10, until_done=True) == 0
    assert state.count.tolist() == [3, 9]
    assert core.advance(world, state, 10) == 10


def test_done_means_stopped_or_arrived_and_needs_a_robot() -> None:
    world, state = scene(robot(), obstacle(pose=[0.1, 0, 0]), robot(pose=[5, 5, 0], goals=[[5, 5]]))
    assert core.advance(world, state, 10, until_done=True) == 0
    world, state = scene(obstacle())
    assert core.advance(world, state, 10, until_done=True) == 10


def test_given_commands_hold_for_one_step() -> None:
    world, state = scene(robot(goals=[[9, 0]]), robot(pose=[0, 5, 0], behavior=None))
    command(state, [-1, 0], [1, 0])
    core.advance(world, state, 2)
    assert state.given.tolist() == [0, 0]
    np.testing.assert_allclose(state.pose[:, 0], [0.0, 0.1], atol=1e-15)  # back and forth; forth and rest


def test_the_phases_make_a_step() -> None:
    world, state = crowd([1, 2], history=True)
    other_world, other = crowd([1, 2], history=True)
    for _ in range(10):
        core.advance(world, state, 1)
        for phase in (
            core.decide, core.limit, core.integrate, core.finish, core.collide, core.arrive, core.sense
        ):  # fmt: skip
            phase(other_world, other)
    assert_identical(everything(state), everything(other))
    assert state.events(1) == other.events(1)
    np.testing.assert_array_equal(state.trajectory(0), other.trajectory(0))


def test_external_motion() -> None:
    world, state = scene(robot(goals=[[3, 0]], sensors=[lidar(1)]), obstacle(pose=[4, 0, 0]), history=True, seeds=[0])
    state.pose[0, 0] = 3.0
    state.control[0] = [0.5, 0, 0]
    core.advance(world, state, 1, external=True)
    assert state.count[0] == 1
    assert state.arrived[0] == 1
    assert state.ranges[0] == pytest.approx(0.8)
    assert state.pose[0].tolist() == [3, 0, 0]
    assert state.control[0, 0] == 0.5
    assert state.trajectory(0)[:, 0].tolist() == [3.0]


FORKED = """
import os, sys
import irsim._core as core
from tests.core.worlds import lidar, robot, scene

world, state = scene(robot(goals=[[9, 9]], sensors=[lidar(9)]), seeds=range(40))
core.advance(world, state, 3, threads=3)
child = os.fork()
for _ in range(5):
    core.advance(world, state, 1, threads=3)
numbers = state.pose.tobytes().hex()
if child == 0:
    open(sys.argv[1], "w").write(numbers)
    os._exit(0)
assert os.waitpid(child, 0)[1] == 0
assert open(sys.argv[1]).read() == numbers
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes that fork")
def test_a_forked_process_has_threads_of_its_own(tmp_path: Path) -> None:
    command = [sys.executable, "-W", "ignore", "-c", FORKED, str(tmp_path / "numbers")]
    subprocess.run(command, check=True, timeout=60)


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="threads are counted on Linux")
def test_threads_go_with_their_state() -> None:
    before = len(os.listdir("/proc/self/task"))
    world, state = scene(robot(), seeds=range(40))
    core.advance(world, state, 2, threads=3)
    core.advance(world, state, 2, threads=3)
    assert len(os.listdir("/proc/self/task")) == before + 2
    del world, state
    assert len(os.listdir("/proc/self/task")) == before


def test_empty_worlds() -> None:
    world, state = scene(seeds=[])
    assert core.advance(world, state, 3, threads=4) == 0
    assert state.pose.shape == (0, 3)
    world, state = scene(seeds=[1, 2])
    assert core.advance(world, state, 3) == 3
    assert core.rollout(world, state, 2).pose.shape == (2, 0, 3)
