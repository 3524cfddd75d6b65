"""Fog: which cells robots have seen, against samples along each beam and the centres of cells."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import irsim._core as core
from tests.core.worlds import PI, circle, fmcw, lidar, obstacle, rectangle, robot, scene
from tests.effort import examples


def fog(columns: int = 20, rows: int = 15, carriers=(0,), views=()) -> core.Fog:
    return core.Fog(
        origin=[-4.0, -3.0], size=[8.0, 6.0], columns=columns, rows=rows, carriers=list(carriers), views=list(views)
    )


def cells_along(pose, bearings, ranges, columns: int, rows: int) -> np.ndarray:
    """Every sample half a cell apart, one by one."""
    seen = np.zeros((columns, rows), bool)
    size = np.array([8.0 / columns, 6.0 / rows])
    step = 0.5 * size.min()
    for bearing, reach in zip(bearings, ranges, strict=True):
        for k in range(int(max(ranges) / step) + 2):
            d = min(k * step, reach)
            p = np.array([pose[0] + d * math.cos(bearing), pose[1] + d * math.sin(bearing)])
            i, j = np.floor((p - (-4.0, -3.0)) / size).astype(int)
            if 0 <= i < columns and 0 <= j < rows:
                seen[i, j] = True
    return seen


@settings(max_examples=examples(60))
@given(st.integers(0, 10_000), st.sampled_from([(20, 15), (37, 8), (1, 1), (80, 60)]), st.sampled_from([0.0, -2.0]))
def test_beams_lift_it(seed: int, shape: tuple[int, int], mounted: float) -> None:
    rng = np.random.default_rng(seed)
    own = rng.uniform([-5, -4, -PI], [5, 4, PI])
    boxes = [
        obstacle(pose=p, parts=[rectangle(1, 0.5)]) for p in rng.uniform([-4, -3, -PI], [4, 3, PI], (4, 3)).tolist()
    ]
    sensor = (lidar, fmcw)[seed % 2](23, angle_range=5.0, offset=[0.2, 0.1, mounted], range_max=3.7)
    carrier = robot(pose=own.tolist(), sensors=[sensor, lidar(9)], behavior=None)  # only the first sensor counts
    world, state = scene(carrier, *boxes, mode=1, fog=fog(*shape))
    assert state.explored.shape == (1, *shape)
    assert not state.explored.any()  # nothing is known before the first step
    core.advance(world, state, 1)
    c, s = math.cos(own[2]), math.sin(own[2])
    eye = own[:2] + np.array([[c, -s], [s, c]]) @ (0.2, 0.1)
    expected = cells_along(eye, own[2] + mounted + state.beam_angles[:23], state.ranges[:23], *shape)
    wrong = np.argwhere(state.explored[0].astype(bool) != expected)
    assert len(wrong) <= 1  # a sample on the edge of a cell


def test_sectors_lift_it() -> None:
    for angle in (0.4, 2.0, 2 * PI):
        pose = [1.0, -0.5, 2.5]
        sight = core.View(object=0, angle=angle, reach=2.2, occlusion=False)
        world, state = scene(robot(pose=pose, behavior=None), fog=fog(40, 30, [], [sight]))
        core.advance(world, state, 1)
        for i in range(40):
            for j in range(30):
                dx, dy = -4 + (i + 0.5) * 0.2 - pose[0], -3 + (j + 0.5) * 0.2 - pose[1]
                off = abs((math.atan2(dy, dx) - pose[2] + PI) % (2 * PI) - PI)
                seen = math.hypot(dx, dy) <= 2.2 and (off <= angle / 2 or angle >= 2 * PI)
                assert state.explored[0, i, j] == seen, (angle, i, j)


def test_what_is_hidden_stays_in_the_fog() -> None:
    wall = obstacle(pose=[1, 0, 0], parts=[rectangle(0.1, 20)])
    explored = {}
    for occlusion in (False, True):
        sight = core.View(object=0, angle=PI, reach=3.0, occlusion=occlusion)
        world, state = scene(robot(behavior=None), wall, fog=fog(40, 30, [], [sight]))
        core.advance(world, state, 1)
        explored[occlusion] = state.explored[0].astype(bool)
    assert explored[False][30, 15]  # 2 m ahead, behind the wall
    assert not explored[True][26:].any()
    near = explored[False].copy()
    near[25:] = False
    near[:21] = False  # beside the eye the centres of cells decide, not the beams
    assert (explored[True] >= near).mean() > 0.99


def test_it_grows_and_returns_with_the_episode() -> None:
    carrier = robot(pose=[-3, 0, 0], goals=[[3, 0]], sensors=[lidar(9, range_max=1.0)])
    world, state = scene(carrier, robot(pose=[-3, 2, 0], parts=[circle(0.1)]), seeds=[1, 2], fog=fog())
    before = state.explored.copy()
    for _ in range(6):
        core.advance(world, state, 4)
        assert (state.explored >= before).all()
        assert state.explored.sum() > before.sum()
        before = state.explored.copy()
    assert state.explored[0].tobytes() == state.explored[1].tobytes()
    state.reset(np.array([1, 0], np.uint8), False)
    assert not state.explored[0].any()
    assert state.explored[1].tobytes() == before[1].tobytes()


def test_worlds_without_fog_have_no_cells() -> None:
    _, state = scene(robot(sensors=[lidar(3)]))
    assert state.explored.size == 0
    with pytest.raises(ValueError, match="cell"):
        scene(robot(), fog=fog(0, 3))
    with pytest.raises(ValueError, match="names an object that does not exist"):
        scene(robot(), fog=fog(views=[core.View(object=3, angle=1.0, reach=1.0, occlusion=False)]))


def test_far_beams_cost_no_more_than_the_world() -> None:
    far = robot(pose=[1e7, 0, PI], behavior=None, sensors=[lidar(3, range_max=1e9, angle_range=0.1)])
    world, state = scene(far, fog=fog())
    core.advance(world, state, 1)
    assert state.explored.sum() >= 19  # the middle beam crosses the world
