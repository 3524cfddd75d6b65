"""The cells of a map against shapely and against beams that look at every cell."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import assume
from hypothesis import strategies as st

import irsim._core as core
from tests.core.test_shapes import ORIGIN, POSE, placed, shape
from tests.core.worlds import apply, circle, lidar, obstacle, polygon, random_placement, rectangle, robot, scene
from tests.effort import for_all

CELLS = st.integers(1, 12)


@st.composite
def grids(draw: st.DrawFn, aligned: bool = False) -> core.OccupancyGrid:
    nx, ny = draw(CELLS), draw(CELLS)
    rng = np.random.default_rng(draw(st.integers(0, 10_000)))
    occupied = (rng.random((nx, ny)) < draw(st.sampled_from([0.1, 0.4, 0.8]))).astype(np.uint8)
    if aligned:
        return core.OccupancyGrid(occupied, (-4.0, -3.0), (1.0, 0.5))
    size, corner = st.floats(0.2, 1.3), st.floats(-6, -1e-3)  # the oracle's library is lost among subnormal numbers
    return core.OccupancyGrid(occupied, (draw(corner), draw(corner)), (draw(size), draw(size)))


def boxes(grid: core.OccupancyGrid) -> list[shapely.Polygon]:
    (x, y), (a, b) = grid.origin, grid.cell
    return [shapely.box(x + i * a, y + j * b, x + (i + 1) * a, y + (j + 1) * b) for i, j in np.argwhere(grid.occupied)]


def meets(grid: core.OccupancyGrid, parts, pose) -> bool:
    touching = core.intersects([core.GridCells(grid=grid)], ORIGIN, parts, pose)
    assert core.intersects(parts, pose, [core.GridCells(grid=grid)], (3.0, 1.0, 2.0)) == touching  # maps do not move
    return touching


@for_all(200, grid=grids(), body=st.lists(shape(), min_size=1, max_size=3), pose=POSE)
def test_any_body_meets_the_cells_it_overlaps(grid, body, pose) -> None:
    cells = shapely.union_all(boxes(grid))
    gap = min((cells.distance(placed(g, pose)) - r for _, g, r in body), default=math.inf)
    assume(not grid.count or abs(gap) > 1e-9 or gap == 0.0)
    expected = grid.count > 0 and gap <= 0.0
    if gap == 0.0 and grid.count:  # an overlap, or a touch that rounding decides
        inner = [placed(g, pose).intersection(cells) for _, g, _ in body]
        assume(any(i.length > 1e-6 for i in inner) or any(r for *_, r in body))
    assert meets(grid, [p for p, *_ in body], pose) == expected


@for_all(200, grid=grids(aligned=True), body=shape())
def test_touching_counts(grid, body) -> None:
    part, geometry, radius = body
    gap = shapely.union_all(boxes(grid)).distance(geometry) - radius if grid.count else math.inf
    assume(radius == 0.0 or abs(gap) > 1e-9)
    assert meets(grid, [part], ORIGIN) == (gap <= 0.0)


def test_a_body_around_a_cell_or_inside_one() -> None:
    occupied = np.zeros((9, 9), np.uint8)
    occupied[4, 4] = 1
    grid = core.OccupancyGrid(occupied, (0.0, 0.0), (1.0, 1.0))
    middle = (4.5, 4.5, 0.3)
    assert meets(grid, [rectangle(6, 6)], middle)
    assert meets(grid, [rectangle(0.1, 0.1)], middle)
    assert meets(grid, [circle(0.01)], middle)
    assert meets(grid, [circle(4)], middle)
    ring = polygon((-3, -3), (3, -3), (3, 3), (-3, 3), (-3, -2.5), (2.5, -2.5), (2.5, 2), (-3, 2))
    assert not meets(grid, [ring], (4.5, 4.5, 0.0))  # the cell lies in the bay of a U
    corner = 2.5 * math.sqrt(2)  # from (2, 2) to the corner (4, 4) of the cell, and less
    assert meets(grid, [circle(corner)], (1.5, 1.5, 0))
    assert not meets(grid, [circle(corner - 1e-9)], (1.5, 1.5, 0))


def nearest_of(grid: core.OccupancyGrid, origin, direction, limit: float) -> float:
    """The beam against every piece of the boundary of the occupied area."""
    if not grid.count:
        return math.inf
    area = shapely.union_all(boxes(grid))
    end = (origin[0] + limit * direction[0], origin[1] + limit * direction[1])
    met = area.boundary.intersection(shapely.LineString([origin, end]))
    points = shapely.get_coordinates(met)
    if not len(points):
        return math.inf
    return float(np.hypot(*(points - origin).T).min())


@for_all(
    300,
    grid=grids(),
    x=st.floats(-8, 12),
    y=st.floats(-8, 12),
    angle=st.floats(-math.pi, math.pi) | st.sampled_from([0.0, math.pi / 2, math.pi, -math.pi / 2]),
)
def test_beams_stop_at_the_outline(grid, x, y, angle) -> None:
    direction = math.cos(angle), math.sin(angle)
    limit = 9.0
    assume(not grid.count or shapely.union_all(boxes(grid)).boundary.distance(shapely.Point(x, y)) > 1e-6)
    expected = nearest_of(grid, (x, y), direction, limit)
    assume(expected > 1e-6)
    assume(not math.isclose(expected, limit, abs_tol=1e-6))
    measured = grid.cast((x, y), direction, limit)
    if math.isclose(measured, expected, abs_tol=1e-9):
        return
    # a beam that grazes a corner may go either way, within rounding
    point = shapely.Point(x + min(measured, expected) * direction[0], y + min(measured, expected) * direction[1])
    corners = shapely.MultiPoint(np.concatenate(grid.outline()))
    assert point.distance(corners) < 1e-7


@for_all(200, grid=grids(aligned=True), line=CELLS, start=st.integers(-2, 13), heading=st.sampled_from(range(4)))
def test_beams_along_a_grid_line_meet_the_cells_on_both_sides(grid, line, start, heading) -> None:
    direction = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))[heading]
    i, j = (start + 0.25, min(line, grid.shape[1])) if heading < 2 else (min(line, grid.shape[0]), start + 0.25)
    origin = -4.0 + i, -3.0 + 0.5 * j
    expected = nearest_of(grid, origin, direction, 40.0)
    assume(expected > 0.0)
    assert grid.cast(origin, direction, 40.0) == expected


def test_beams_do_not_slip_between_cells_that_share_a_corner() -> None:
    occupied = np.zeros((20, 20), np.uint8)
    for k in range(20):
        occupied[k, 19 - k] = 1
    for cell in (0.1, 0.25, 1 / 3, 1.0):
        grid = core.OccupancyGrid(occupied, (0.0, 0.0), (cell, cell))
        diagonal = math.sqrt(0.5)
        for k in range(1, 19):  # exactly through the corner of two occupied cells
            corner = np.array([k * cell, (20 - k) * cell])
            for start in (0.3, 1.7, 2.5):
                origin = corner - start * cell * np.array([1, 1])
                measured = grid.cast(tuple(origin), (diagonal, diagonal), 100.0)
                assert measured == pytest.approx(start * cell / diagonal, abs=1e-9)


def test_from_inside_the_way_out_is_seen() -> None:
    occupied = np.ones((6, 3), np.uint8)
    occupied[3, 1] = 0
    grid = core.OccupancyGrid(occupied, (0.0, 0.0), (1.0, 1.0))
    assert grid.cast((0.5, 1.5), (1.0, 0.0), 10.0) == 2.5  # the hole
    assert grid.cast((0.5, 0.5), (1.0, 0.0), 10.0) == 5.5  # the edge of the map
    assert grid.cast((0.5, 0.5), (1.0, 0.0), 5.0) == math.inf
    assert grid.cast((-2.0, 0.5), (1.0, 0.0), 10.0) == 2.0
    assert grid.cast((3.5, 1.5), (0.0, 1.0), 10.0) == 0.5
    assert grid.cast((math.nan, 0.5), (1.0, 0.0), 10.0) == math.inf


@for_all(100, grid=grids())
def test_outline_is_the_boundary_of_the_union(grid) -> None:
    rings = grid.outline()
    area = shapely.union_all(boxes(grid)) if grid.count else shapely.Polygon()
    doubled = sum(float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) for x, y in (ring.T for ring in rings))
    assert doubled / 2 == pytest.approx(area.area)  # holes go the other way round
    lines = [shapely.LinearRing(ring) for ring in rings]
    assert sum(line.length for line in lines) == pytest.approx(area.length)
    for ring in rings:
        steps = np.roll(ring, -1, axis=0) - ring
        turned = np.abs(steps).argmax(axis=1)
        assert (turned != np.roll(turned, 1)).all(), "straight runs are one piece"
        assert (np.abs(steps).min(axis=1) == 0).all()


@for_all(50, grid=grids())
def test_clearance_counts_cells(grid) -> None:
    full = np.argwhere(grid.occupied)
    for i, j in np.ndindex(grid.shape):
        away = np.abs(full - (i, j)).max(axis=1).min() if len(full) else 255
        assert grid.clearance[i, j] == away or (not len(full) and grid.clearance[i, j] == 255)


def wall_map() -> core.GridCells:
    """A wall from (2, 0) to (2.5, 5) with a gap above y = 3."""
    occupied = np.zeros((20, 20), np.uint8)
    occupied[4, :6] = 1
    return core.GridCells(grid=core.OccupancyGrid(occupied, (0.0, 0.0), (0.5, 0.5)))


def test_a_robot_stops_at_a_wall_and_both_know() -> None:
    world, state = scene(robot(pose=[1.0, 1.0, 0.0], parts=[circle(0.3)]), obstacle(parts=[wall_map()]), step_time=0.1)
    apply(world, state, [1.0, 0.0], steps=20)
    assert state.pose[0, 0] == pytest.approx(1.7)
    assert state.collided.tolist() == [1, 1]
    [(kind, step, who, partner, x, y)] = state.events(0)
    assert (kind, step, who, partner) == ("collision", 7, 0, 1)
    assert (x, y) == pytest.approx((2.0, 1.0))


def test_lidar_sees_the_map_and_what_stands_before_it() -> None:
    _world, state = scene(
        robot(pose=[1.0, 1.25, 0.0], sensors=[lidar(5, angle_range=math.pi, range_max=4.0)]),
        robot(pose=[1.0, 2.0, 0.0], parts=[circle(0.2)]),
        obstacle(parts=[wall_map()]),
    )
    assert state.hits.tolist() == [-1, 2, 2, 2, 1]
    assert state.ranges == pytest.approx([4.0, math.sqrt(2), 1.0, math.sqrt(2), 0.55])


def test_random_placement_keeps_clear_of_the_cells() -> None:
    rng = np.random.default_rng(2)
    grid = core.OccupancyGrid((rng.random((40, 40)) < 0.2).astype(np.uint8), (0.0, 0.0), (0.25, 0.25))
    placement = random_placement(
        objects=list(range(8)), range_low=[0, 0, -3], range_high=[10, 10, 3], min_distance=0.1, attempts=20_000
    )
    bodies = [robot(parts=[circle(0.2)]) for _ in range(8)]
    _, state = scene(*bodies, obstacle(parts=[core.GridCells(grid=grid)]), placements=[placement], seeds=(1, 2, 3))
    assert (state.failed_placement < 0).all()
    assert not state.collided.any()
    cells = shapely.union_all(boxes(grid))
    for row, goal in enumerate(state.goal):
        if row % 9 < 8:
            assert cells.distance(shapely.Point(goal[:2])) > 0.2


def noise(**overrides) -> core.PerlinCells:
    options = {
        "size": [40, 30],
        "every": 1,
        "origin": [0.0, 0.0],
        "cell_size": [0.25, 0.25],
        "complexity": 0.142857,
        "fill": 0.38,
        "fractal": 1,
        "attenuation": 0.5,
    }
    return core.PerlinCells(**{**options, **overrides})


def test_noise_is_drawn_per_scene_and_seed() -> None:
    _, state = scene(robot(), obstacle(parts=[noise()]), seeds=(1, 2, 1))
    first = [state.cells(row).occupied for row in (1, 3, 5)]
    assert (first[0] == first[2]).all()
    assert (first[0] != first[1]).any()
    assert first[0].mean() == pytest.approx(0.38, abs=0.01)
    state.reset(np.array([1, 0, 0], np.uint8), False)
    assert (state.cells(1).occupied == first[0]).all()
    state.reset(np.array([1, 0, 0], np.uint8), True)
    assert (state.cells(1).occupied != first[0]).any()
    assert state.cells(0) is None
    _, thin = scene(robot(), obstacle(parts=[noise(every=3)]), seeds=(2,))
    whole, cells = first[1], thin.cells(1).occupied
    for row, column in np.ndindex(*cells.shape):  # of nine cells the fullest: no wall is lost
        assert cells[row, column] == whole[3 * row : 3 * row + 3, 3 * column : 3 * column + 3].max()


def test_a_room_collides_and_is_seen_from_inside() -> None:
    room = core.Room(vertices=[[0, 0], [0, 6], [8, 6], [8, 0]])
    world, state = scene(
        robot(pose=[4.0, 3.0, 0.0], sensors=[lidar(4, angle_range=1.5 * math.pi)], parts=[circle(0.25)]),
        obstacle(parts=[room]),
    )
    assert state.collided.tolist() == [0, 0]
    assert state.ranges == pytest.approx([3 * math.sqrt(2)] * 4)
    apply(world, state, [1.0, 0.0], steps=60)
    assert state.pose[0, 0] == pytest.approx(7.8)
    assert state.collided.tolist() == [1, 1]
