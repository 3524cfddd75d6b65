"""Fields of view and fog, against sectors, lines of sight and samples along each beam."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import strategies as st

import irsim._core as core
from tests.core import oracle
from tests.core.worlds import PI, advanced, circle, fmcw, lidar, line, obstacle, polygon, rectangle, robot, scene
from tests.effort import for_all

SHAPES = [
    [circle(0.5)],
    [circle(0.3, (0.2, -0.4))],
    [rectangle(1, 2)],
    [rectangle(9, 7)],
    [polygon((0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3))],
    [polygon((0, 0), (0, 1), (1, 1))],
    [line((-2, 0), (0, 1), (2, 0), (1, -1))],
    [rectangle(2, 0.5), circle(0.6, (1, 0.4))],
]
ARC = 1000


def random_things(rng: np.random.Generator, count: int, clear: int) -> list[core.ObjectSpec]:
    """Things of any shape, every other one static; each one of so many is unobstructed."""
    return [
        obstacle(
            pose=rng.uniform([-5, -5, -PI], [5, 5, PI]).tolist(),
            parts=SHAPES[rng.integers(len(SHAPES))],
            static=bool(k % 2),
            unobstructed=k % clear == clear - 1,
        )
        for k in range(count)
    ]


def seen_by_rays(own: Sequence[float], angle: float, reach: float, bodies: dict[int, Any], clear: int = 0) -> set[int]:
    """Rows that one of 600 lines of sight meets first; one of so many rows hides nothing."""
    eye, seen = shapely.Point(own[:2]), set[int]()
    for bearing in own[2] + np.linspace(-angle / 2 + 1e-6, angle / 2 - 1e-6, 600):
        ray = shapely.LineString([own[:2], np.add(own[:2], reach * np.array([math.cos(bearing), math.sin(bearing)]))])
        near = {}
        for row, body in bodies.items():
            hit = ray.intersection(body if body.geom_type == "LineString" else body.boundary)
            near[row] = math.inf if hit.is_empty else eye.distance(hit)
        first = min((d for row, d in near.items() if not clear or row % clear), default=math.inf)
        seen |= {row for row, d in near.items() if d < math.inf and d <= first + 1e-9}
    return seen


def sector_of(pose, angle: float, reach: float) -> shapely.Geometry:
    x, y, theta = pose
    if angle >= 2 * PI:
        return shapely.Point(x, y).buffer(reach, quad_segs=ARC // 4)
    bearings = theta + np.linspace(-angle / 2, angle / 2, ARC)
    rim = np.stack([x + reach * np.cos(bearings), y + reach * np.sin(bearings)], axis=1)
    return shapely.Polygon([(x, y), *rim])


@for_all(120, st.data())
def test_seen_is_what_meets_the_sector(data: st.DataObject) -> None:
    rng = np.random.default_rng(data.draw(st.integers(0, 100_000)))
    angle = data.draw(st.sampled_from([0.05, 0.6, PI / 2, PI - 0.1, PI, PI + 0.2, 5.0, 6.2, 2 * PI]))
    reach = data.draw(st.sampled_from([0.4, 2.0, 6.0]))
    count = data.draw(st.integers(1, 10))
    objects = random_things(rng, count, 3)
    own = rng.uniform([-1, -1, -PI], [1, 1, PI]).tolist()
    _, state = scene(robot(pose=own), *objects, mode=1)
    seen = state.in_view(0, angle, reach, False)
    sector = sector_of(own, angle, reach)
    for row in range(1, count + 1):
        body = oracle.shape_of(state, row)
        if body.intersects(sector.buffer(-1e-3)) or body.buffer(-1e-3).intersects(sector):
            assert row in seen
        elif body.distance(sector) > 1e-3:
            assert row not in seen
    assert 0 not in seen
    assert seen == sorted(seen)


def view(*objects: core.ObjectSpec, angle: float = PI / 2, reach: float = 5.0, hidden: bool = False) -> list[int]:
    return scene(robot(), *objects, mode=1)[1].in_view(0, angle, reach, hidden)


def test_edges_count() -> None:
    beside = obstacle(pose=[0, 2, 0], parts=[rectangle(2, 2)])  # its corner (1, 1) is at 45 degrees
    assert view(beside, angle=PI / 2 + 1e-9) == [1]
    assert view(beside, angle=PI / 2 - 1e-9) == []
    assert view(obstacle(pose=[6, 0, 0], parts=[rectangle(2, 2)]), reach=5.0) == [1]
    assert view(obstacle(pose=[6, 0, 0], parts=[rectangle(2, 2)]), reach=4.999) == []
    assert view(obstacle(pose=[6, 0, 0], parts=[circle(1.0)]), reach=5.0) == [1]
    assert view(obstacle(pose=[-1, 0, 0], parts=[circle(0.5)]), angle=0.0) == []
    assert view(obstacle(pose=[2, 0, 0], parts=[circle(0.5)]), angle=0.0) == [1]
    assert view(obstacle(pose=[2, 0, 0]), angle=math.nan) == []
    assert view(obstacle(pose=[2, 0, 0]), reach=math.nan) == []


def test_a_changed_pose_counts_at_once() -> None:
    _, state = scene(robot(), robot(pose=[-3, 0, 0]), mode=1)
    assert state.in_view(0, 1.0, 5.0, False) == []
    state.pose[1, 0] = 3.0
    assert state.in_view(0, 1.0, 5.0, False) == [1]


def test_occlusion_by_a_wall() -> None:
    behind = obstacle(pose=[4, 0, 0], parts=[circle(0.5)])
    wall = obstacle(pose=[2, 0, 0], parts=[rectangle(0.2, 2)])
    low = obstacle(pose=[2, -0.5, 0], parts=[rectangle(0.2, 0.8)])
    assert view(behind, wall) == [1, 2]
    assert view(behind, wall, hidden=True) == [2]
    assert view(behind, low, hidden=True) == [1, 2]  # its upper half looks over
    assert view(behind, obstacle(pose=[2, 0, 0], parts=[rectangle(0.2, 2)], unobstructed=True), hidden=True) == [1, 2]
    two = [obstacle(pose=[2, y, 0], parts=[rectangle(0.2, 1.0)]) for y in (-0.55, 0.55)]  # a slit of 0.1 m
    assert view(behind, *two, hidden=True) == [1, 2, 3]
    assert view(obstacle(pose=[4, 0, 0], parts=[line((0, -1), (0, 1))]), hidden=True) == [1]


@for_all(40, st.integers(0, 100_000), st.sampled_from([0.5, PI / 2, 4.0, 2 * PI]))
def test_occlusion_agrees_with_many_lines_of_sight(seed: int, angle: float) -> None:
    """Sampled lines of sight: what one of them sees is seen; what is seen is seen by one, slivers apart."""
    rng = np.random.default_rng(seed)
    count, reach = int(rng.integers(2, 9)), 6.0
    objects = random_things(rng, count, 4)
    own = rng.uniform([-1, -1, -PI], [1, 1, PI]).tolist()
    _, state = scene(robot(pose=own), *objects, mode=1)
    bodies = {row: oracle.shape_of(state, row) for row in range(1, count + 1)}
    if any(body.boundary.distance(shapely.Point(own[:2])) < 0.05 for body in bodies.values()):
        return
    seen = set(state.in_view(0, angle, reach, True))
    assert seen <= set(state.in_view(0, angle, reach, False))
    sampled, eye = seen_by_rays(own, angle, reach, bodies, clear=4), shapely.Point(own[:2])
    inside = {row for row, body in bodies.items() if body.geom_type != "LineString" and body.contains(eye)}
    assert sampled <= seen | inside
    assert len(seen - sampled - inside) <= 1  # what is narrower than the lines are apart


@pytest.mark.parametrize("hidden", [False, True])
def test_worlds_of_a_batch_look_for_themselves(hidden: bool) -> None:
    objects = [robot(), *(obstacle(pose=[2 + k, 0.1 * k, 0]) for k in range(4))]
    _, state = scene(*objects, seeds=[1, 2], mode=1)
    state.pose[5:, 0] += 100.0
    state.refresh()
    assert state.in_view(0, 1.0, 8.0, hidden) == state.in_view(5, 1.0, 8.0, hidden) != []


def cells(rng: np.random.Generator, density: float) -> tuple[core.OccupancyGrid, shapely.Geometry]:
    occupied = (rng.random((14, 11)) < density).astype(np.uint8)
    grid = core.OccupancyGrid(occupied, (-5.2, -4.1), (0.75, 0.8))
    boxes = [
        shapely.box(-5.2 + i * 0.75, -4.1 + j * 0.8, -5.2 + (i + 1) * 0.75, -4.1 + (j + 1) * 0.8)
        for i, j in np.argwhere(occupied)
    ]
    return grid, shapely.union_all(boxes)


@for_all(80, st.integers(0, 100_000), st.sampled_from([0.2, 1.5, PI, 4.0, 2 * PI]), st.sampled_from([0.02, 0.2]))
def test_cells_of_a_map_are_seen(seed: int, angle: float, density: float) -> None:
    rng = np.random.default_rng(seed)
    grid, body = cells(rng, density)
    own = rng.uniform([-5, -4, -PI], [5, 4, PI]).tolist()
    _, state = scene(robot(pose=own), obstacle(parts=[core.GridCells(grid=grid)]), mode=1)
    seen, sector = state.in_view(0, angle, 2.5, False), sector_of(own, angle, 2.5)
    if body.is_empty:
        assert seen == []
    elif body.intersects(sector.buffer(-1e-3)):
        assert seen == [1]
    elif body.distance(sector) > 1e-3:
        assert seen == []


@for_all(20, st.integers(0, 100_000), st.sampled_from([1.5, 2 * PI]))
def test_cells_hide_what_is_behind_them(seed: int, angle: float) -> None:
    rng = np.random.default_rng(seed)
    grid, walls = cells(rng, 0.12)
    own = [*rng.uniform(-2, 2, 2), rng.uniform(-PI, PI)]
    eye, reach = shapely.Point(own[:2]), 7.0
    objects = [obstacle(pose=[*rng.uniform(-5, 5, 2), 1.0], parts=SHAPES[rng.integers(3)]) for _ in range(4)]
    _, state = scene(robot(pose=own), *objects, obstacle(parts=[core.GridCells(grid=grid)]), mode=1)
    bodies = {row: oracle.shape_of(state, row) for row in range(1, 5)}
    if min(body.distance(eye) for body in [walls, *bodies.values()]) < 0.05:
        return
    seen = set(state.in_view(0, angle, reach, True))
    sampled = seen_by_rays(own, angle, reach, {**bodies, 5: walls})
    assert sampled <= seen
    assert len(seen - sampled) <= 1


def test_inside_walls_the_room_is_seen() -> None:
    room = core.Room(vertices=[(-5, -5), (5, -5), (5, 5), (-5, 5)])
    assert view(obstacle(parts=[room]), reach=4.9) == []
    assert view(obstacle(parts=[room]), reach=5.1) == [1]
    assert view(obstacle(pose=[20, 0, 0], parts=[room]), reach=0.5) == [1]


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


@for_all(
    60, st.integers(0, 10_000), st.sampled_from([(20, 15), (37, 8), (1, 1), (80, 60)]), st.sampled_from([0.0, -2.0])
)
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
        state = advanced(1, robot(pose=pose, behavior=None), fog=fog(40, 30, [], [sight]))
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
        state = advanced(1, robot(behavior=None), wall, fog=fog(40, 30, [], [sight]))
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
    state = advanced(1, far, fog=fog())
    assert state.explored.sum() >= 19  # the middle beam crosses the world
