"""Reset, reseed, scenes and noise episodes; the record of a world; the streams of draws."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import strategies as st

import irsim._core as core
from tests.core.worlds import (
    advanced,
    assert_identical,
    circle,
    everything,
    lidar,
    obstacle,
    random_placement,
    robot,
    rows_of,
    scene,
)
from tests.effort import for_all

pytestmark = pytest.mark.every_python

ALL = np.ones(1, np.uint8)
NOISY = core.DiffOptions(noise=True, alpha=[0.03, 0.01, 0.01, 0.03], track=0.3)


def crowd(seeds=(3,), **options) -> tuple[core.World, core.State]:
    """Noise, random shapes and placements, wanderers, a lidar: everything that draws."""
    part = core.RandomPolygon(
        center_range=[0, 0, 0, 0],
        avg_radius_range=[0.2, 0.6],
        irregularity_range=[0, 1],
        spikeyness_range=[0, 0.5],
        num_vertices_range=[4, 8],
        closed=True,
    )
    objects = [
        robot(drive=NOISY, sensors=[lidar(20, noise=True)]),
        robot(drive=NOISY, wander=True, pose=[9, 9, 0]),
        *(obstacle(parts=[part]) for _ in range(4)),
        robot(drive=NOISY),
    ]
    placement = random_placement(
        objects=[0, 2, 3, 4, 5, 6], range_low=[0, 0, -3], range_high=[8, 8, 3], min_distance=0.8, attempts=1000
    )
    return scene(*objects, seeds=seeds, placements=[placement], **options)


def test_reset_restores_the_scene_and_draws_other_noise() -> None:
    world, state = crowd()
    start = everything(state)
    core.advance(world, state, 20)
    first = everything(state)
    state.reset(ALL, False)
    again = everything(state)
    for name in ("pose", "control", "twist", "arrived", "collided", "stopped", "radius", "count", "scene"):
        np.testing.assert_array_equal(start[name], again[name])
    assert state.noise[0] == 1
    assert state.events(0) == [e for e in state.events(0) if e[1] == 0]
    assert not np.array_equal(start["ranges"], again["ranges"])  # another noise episode
    core.advance(world, state, 20)
    assert not np.array_equal(first["pose"], state.pose)


def test_the_next_scene_does_not_depend_on_what_happened_before() -> None:
    a, b = crowd()[1], None
    world, b = crowd()
    core.advance(world, b, 30)
    b.reset(ALL, False)
    core.advance(world, b, 7)
    a.reset(ALL, True)
    b.reset(ALL, True)
    assert (a.scene[0], a.noise[0]) == (1, 0)
    assert_identical(everything(a), everything(b))


def test_scenes_differ() -> None:
    _, state = crowd()
    first = everything(state)
    state.reset(ALL, True)
    for name in ("pose", "radius", "goal", "ranges"):
        assert not np.array_equal(first[name], getattr(state, name))


@pytest.mark.parametrize("next_scene", [False, True])
def test_reseed_starts_over_at_the_next_reset(next_scene: bool) -> None:
    world, state = crowd([3])
    core.advance(world, state, 5)
    state.reset(ALL, True)
    state.reseed(np.array([8], np.uint64), ALL)
    core.advance(world, state, 3)
    state.reset(ALL, next_scene)
    assert_identical(everything(state), everything(crowd([8])[1]))
    state.reset(ALL, True)
    assert state.scene[0] == 1


def test_only_masked_worlds_are_reset() -> None:
    world, state = crowd([1, 2, 3])
    core.advance(world, state, 10)
    before = everything(state)
    state.reseed(np.array([9, 9, 9], np.uint64), np.array([0, 0, 1], np.uint8))
    state.reset(np.array([0, 1, 1], np.uint8), True)
    after = everything(state)
    assert_identical(rows_of(before, 0, 3), rows_of(after, 0, 3))
    assert state.count.tolist() == [10, 0, 0]
    assert state.scene.tolist() == [0, 1, 0]
    assert state.seed.tolist() == [1, 2, 9]


@pytest.mark.parametrize("next_scene", [False, True])
def test_resets_do_not_depend_on_the_number_of_threads(next_scene: bool) -> None:
    seeds = list(range(20))
    mask = np.array([k % 3 != 0 for k in seeds], np.uint8)
    results = []
    for threads in (1, 3, 50):
        world, state = crowd(seeds)
        core.advance(world, state, 5)
        state.reset(mask, next_scene, threads)
        core.advance(world, state, 3)
        results.append(everything(state))
    assert_identical(results[0], results[1])
    assert_identical(results[0], results[2])


def test_set_initial() -> None:
    world, state = scene(robot(pose=[1, 1, 0], extra=[0.5, 0.25]), obstacle(pose=[5, 5, 0], extra=[2.0]))
    state.pose[:] = [[2, 2, 1], [6, 6, 1]]
    state.extra[0] = [0.1, 0.2]
    state.control[0] = [0.3, 0, 0]
    state.set_initial(0, pose=True, control=True)
    state.refresh()
    core.advance(world, state, 5)
    state.reset(ALL, False)
    assert state.pose.tolist() == [[2, 2, 1], [5, 5, 0]]
    assert state.extra.tolist() == [[0.1, 0.2], [2.0, 0.0]]
    assert state.control[0].tolist() == [0.3, 0, 0]
    assert state.collision_pairs(0).tolist() == []
    state.reset(ALL, True)
    assert state.pose.tolist() == [[1, 1, 0], [5, 5, 0]]  # a new scene starts from the template


def test_events_and_history_start_over() -> None:
    world, state = scene(robot(goals=[[0.5, 0]], behavior=core.DashOptions(angle_tolerance=0.1)), history=True)
    core.advance(world, state, 10)
    assert len(state.events(0)) == 1
    assert state.trajectory(0).shape == (10, 4)
    np.testing.assert_allclose(state.trajectory(0)[:, 0].max(), state.pose[0, 0])
    seen = state.event_count
    state.reset(ALL, False)
    assert state.events(0) == []
    assert state.trajectory(0).shape == (0, 4)
    core.advance(world, state, 10)
    assert state.event_count == seen + 1


def test_history_skips_steps_without_motion() -> None:
    state = advanced(
        20, robot(goals=[[9, 0]], extra=[1.0, 2.0]), obstacle(pose=[1, 0, 0], parts=[circle(0.3)]), history=True
    )
    assert state.stopped[0] == 1
    track = state.trajectory(0)
    assert track.shape == (5, 5)
    np.testing.assert_allclose(track[:, 0], [0.1, 0.2, 0.3, 0.4, 0.5])
    np.testing.assert_array_equal(track[:, 3:], [[1.0, 2.0]] * 5)  # extra rows keep their value
    assert state.trajectory(1).shape == (0, 5)
    with pytest.raises(ValueError, match="history"):
        scene(robot())[1].trajectory(0)


def test_a_log_holds_what_a_rollout_returns() -> None:
    world, state = crowd([4])
    movers = list(range(0, world.objects, 2))
    log = core.Log(world, movers, 2, True)
    log.attach(state)
    start = state.pose.copy(), state.control.copy()
    log.add(state)
    trace = core.rollout(world, state, 30, returns=True)
    assert (log.first, log.rows) == (0, 31)
    np.testing.assert_array_equal(log.pose, np.concatenate([start[0][None], trace.pose])[:, movers])
    control = np.concatenate([start[1][None], trace.control])[:, movers, :2]
    np.testing.assert_array_equal(log.control, control.astype(np.float32))
    for rows, values, whole in (
        (log.goal_rows, log.goal, trace.goal),
        (log.flag_rows, log.flags, trace.arrived + 2 * trace.collided + 4 * trace.stopped),
        (log.scan_rows, log.ranges, trace.returns),
    ):
        held = np.repeat(values, np.diff([*rows, 31]), axis=0)
        np.testing.assert_array_equal(held[1:], whole)
    assert len(log.goal_rows) < 31


def test_what_was_looked_at_stays_when_the_log_goes_on() -> None:
    world, state = scene(robot(goals=[[9, 0]]))
    log = core.Log(world, [0], 2, False)
    log.attach(state)
    core.advance(world, state, 3)
    pose, goal = log.pose, log.goal
    kept = pose.copy(), goal.copy()
    core.advance(world, state, 50)
    log.clear()
    core.advance(world, state, 50)
    np.testing.assert_array_equal(pose, kept[0])
    np.testing.assert_array_equal(goal, kept[1])
    assert (log.first, log.rows) == (54, 50)
    assert log.goal_rows.tolist() == [0]


def test_a_log_ends_when_it_is_detached() -> None:
    world, state = scene(robot(goals=[[9, 0]]))
    log = core.Log(world, [0], 2, True)
    with pytest.raises(ValueError, match="not attached"):
        log.add(state)
    log.attach(state)
    core.advance(world, state, 3)
    log.detach(state)
    core.advance(world, state, 3)
    assert log.rows == 3
    assert log.ranges.shape == (0, 0)


def test_only_the_first_world_is_written_down() -> None:
    world, state = crowd([4, 5, 6])
    log = core.Log(world, [0], 2, False)
    log.attach(state)
    core.advance(world, state, 10, threads=3)
    alone_world, alone = crowd([4])
    trace = core.rollout(alone_world, alone, 10)
    np.testing.assert_array_equal(log.pose[:, 0], trace.pose[:, 0])


def test_logs_fit_their_world() -> None:
    world, state = scene(robot())
    other_world, _ = scene(robot(), robot(pose=[5, 5, 0]))
    with pytest.raises(ValueError, match="another world"):
        core.Log(other_world, [0, 1], 2, False).attach(state)
    with pytest.raises(IndexError):
        core.Log(world, [3], 2, False)
    with pytest.raises(ValueError, match="three"):
        core.Log(world, [0], 4, False)


WORD = st.integers(0, 2**64 - 1)
HALF = st.integers(0, 2**32 - 1)


@for_all(50, seed=WORD, scene=HALF, noise=HALF, stream=WORD, number=WORD, draw=WORD)
def test_blocks_are_those_of_numpy(seed: int, scene: int, noise: int, stream: int, number: int, draw: int) -> None:
    counter = draw | number << 64 | stream << 128
    before = (counter - 1) % 2**256  # NumPy counts before it draws
    words = [(before >> 64 * k) & (2**64 - 1) for k in range(4)]
    key = np.array([seed, scene << 32 | noise], dtype=np.uint64)
    expected = np.random.Philox(counter=np.array(words, dtype=np.uint64), key=key).random_raw(4)
    assert core.random_bits(seed, scene, noise, stream, number, draw) == tuple(int(w) for w in expected)


def test_streams_have_names() -> None:
    assert sorted(core.STREAMS.values()) == list(range(len(core.STREAMS)))
    assert set(core.STREAMS) == {
        "placement", "shape", "goal", "motion", "sensor", "behavior", "planner", "map", "user",
        "perturbation", "policy", "task", "actuation", "slip",
    }  # fmt: skip
