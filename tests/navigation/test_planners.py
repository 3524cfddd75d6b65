"""Planners: shortest on their cells or by samples, free of collisions, through gaps where the footprint fits."""

from __future__ import annotations

import heapq
import math
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import strategies as st
from numpy.typing import NDArray

from irsim.lib.path_planners import RRT, AStarPlanner, InformedRRTStar, JPSPlanner, PRMPlanner, RRTStar
from irsim.navigation.map import Map, cells_of, footprint_of, terrain_of
from tests.effort import for_all

pytestmark = pytest.mark.one_python

Path = NDArray[np.float64]
DISC = shapely.Point(0, 0).buffer(0.3)


def open_cells(env_map: Map, robot: Any = None) -> NDArray[np.bool_]:
    return terrain_of(env_map).open_cells(footprint_of(robot), 0.0, cells_of(env_map)).astype(bool)


def dijkstra(free: NDArray[np.bool_], start: tuple[int, int], goal: tuple[int, int], rx: float, ry: float) -> float:
    """Cost of the shortest path over eight neighbours that cuts no corner: the law, written down plainly."""
    cost = {start: 0.0}
    queue = [(0.0, start)]
    while queue:
        spent, (i, j) = heapq.heappop(queue)
        if (i, j) == goal:
            return spent
        if spent > cost[i, j]:
            continue
        for di, dj in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)):
            a, b = i + di, j + dj
            if not (0 <= a < free.shape[0] and 0 <= b < free.shape[1] and free[a, b]):
                continue
            if di and dj and not (free[a, j] and free[i, b]):
                continue
            through = spent + math.hypot(di * rx, dj * ry)
            if through < cost.get((a, b), math.inf):
                cost[a, b] = through
                heapq.heappush(queue, (through, (a, b)))
    return math.inf


def length(path: Path) -> float:
    return float(np.linalg.norm(np.diff(path, axis=1), axis=0).sum())


grids = st.tuples(st.integers(3, 14), st.integers(3, 14), st.integers(0, 2**31), st.floats(0.0, 0.5)).map(
    lambda t: (np.random.default_rng(t[2]).random((t[0], t[1])) < t[3]) * 100.0
)


@for_all(150, grids, st.data())
def test_shortest_on_a_grid(grid: NDArray[np.float64], data: st.DataObject) -> None:
    nx, ny = grid.shape
    env_map = Map(nx * 0.5, ny * 0.4, 0.5, grid=grid, world_offset=(-1.0, 2.0))
    cells = st.tuples(st.integers(0, nx - 1), st.integers(0, ny - 1))
    start, goal = data.draw(cells), data.draw(cells)
    free = open_cells(env_map)
    assert (free == (grid <= 50)).all(), "a cell blocks no other cell"
    rx, ry = 0.5, 0.4
    a, b = (np.array([-1.0 + (i + 0.5) * rx, 2.0 + (j + 0.5) * ry]) for i, j in (start, goal))
    astar, jps = AStarPlanner(env_map), JPSPlanner(env_map)
    path, jumped = astar.planning(a, b, show_animation=False), jps.planning(a, b, show_animation=False)
    expected = dijkstra(free, start, goal, rx, ry) if free[goal] else math.inf
    assert (path is None) == math.isinf(expected)
    assert (jumped is None) == (math.isinf(expected) or not free[start])
    for line, planner in ((path, astar), (jumped, jps)):
        if line is None:
            continue
        assert np.allclose(line[:, [0, -1]], np.column_stack([b, a])), "paths run from the goal to the start"
        assert length(line) == pytest.approx(expected, abs=1e-9) == planner.end.cost
        steps = np.abs(np.diff(line, axis=1)) / [[rx], [ry]]
        assert (steps.round(6).max(axis=0, initial=0) <= 1).all(), "cell by cell"


shapes = st.one_of(
    st.floats(0.1, 0.6).map(lambda r: shapely.Point(0, 0).buffer(r)),
    st.tuples(st.floats(0.2, 1.2), st.floats(0.1, 0.6)).map(
        lambda s: shapely.box(-s[0] / 2, -s[1] / 2, s[0] / 2, s[1] / 2)
    ),
    st.just(shapely.Polygon([(-0.3, -0.3), (0.5, -0.3), (0.5, 0.0), (0.0, 0.0), (0.0, 0.4), (-0.3, 0.4)])),
)


@st.composite
def scenes(draw: st.DrawFn) -> list[Any]:
    things: list[Any] = []
    for _ in range(draw(st.integers(0, 8))):
        x, y = draw(st.floats(0, 6)), draw(st.floats(0, 6))
        kind = draw(st.integers(0, 2))
        if kind == 0:
            things.append(shapely.Point(x, y).buffer(draw(st.floats(0.02, 0.8))))
        elif kind == 1:
            w, h, turn = draw(st.floats(0.05, 2.0)), draw(st.floats(0.05, 2.0)), draw(st.floats(0, 180))
            things.append(shapely.affinity.rotate(shapely.box(x - w, y - h, x + w, y + h), turn))
        else:
            things.append(shapely.LineString([(x, y), (draw(st.floats(0, 6)), draw(st.floats(0, 6)))]))
    return things


@for_all(80, scenes(), shapes, st.booleans())
def test_paths_are_free_of_collisions(things: list[Any], robot: Any, smooth: bool) -> None:
    env_map = Map(6, 6, 0.25, things)
    free = open_cells(env_map, robot)
    start, goal = (0.9, 0.8), (5.1, 5.2)
    ends = [tuple(int(v / 0.25) for v in p) for p in (start, goal)]
    costs = []
    for cls in (AStarPlanner, JPSPlanner):
        planner = cls(env_map, robot, smooth=smooth)
        path = planner.planning(start, goal, show_animation=False)
        if path is None:
            assert not free[ends[0]] or math.isinf(dijkstra(free, ends[0], ends[1], 0.25, 0.25)) or not free[ends[1]]
            continue
        if not smooth:
            assert planner.end.cost == pytest.approx(dijkstra(free, ends[0], ends[1], 0.25, 0.25), abs=1e-9)
        costs.append(planner.end.cost)
        if not free[ends[0]]:
            continue
        blocked = shapely.union_all([thing.buffer(-1e-9) if thing.area else thing for thing in things])
        for a, b in zip(path.T[:-1], path.T[1:], strict=True):
            for t in np.linspace(0, 1, 5):
                x, y = a + (b - a) * t
                assert not shapely.affinity.translate(robot, x, y).buffer(-1e-7).intersects(blocked)
    if len(costs) == 2 and not smooth:
        assert costs[0] == pytest.approx(costs[1], abs=1e-9)


@pytest.mark.parametrize(("gap", "fits"), [(0.62, True), (0.59, False)])
def test_a_gap_is_passed_exactly_if_the_footprint_fits(gap: float, fits: bool) -> None:
    # the middle of the gap is the middle of a row of cells
    middle = 2.55
    walls = [shapely.box(2.4, 0, 2.6, middle - gap / 2), shapely.box(2.4, middle + gap / 2, 2.6, 5)]
    env_map = Map(5, 5, 0.1, walls)
    for cls in (AStarPlanner, JPSPlanner):
        path = cls(env_map, DISC).planning((1, 1), (4, 4), show_animation=False)
        assert (path is not None) == fits


def test_no_path() -> None:
    env_map = Map(5, 5, 0.1, [shapely.box(2, -1, 3, 6)])
    for cls in (AStarPlanner, JPSPlanner):
        planner = cls(env_map)
        assert planner.planning((1, 1), (4, 4), show_animation=False) is None
        assert math.isinf(planner.end.cost)


def test_smoothing_shortens() -> None:
    env_map = Map(10, 10, 0.1, [shapely.box(4, 0, 5, 6)])
    plain = AStarPlanner(env_map, DISC).planning((1, 1), (9, 2), show_animation=False)
    smooth = AStarPlanner(env_map, DISC, smooth=True).planning((1, 1), (9, 2), show_animation=False)
    assert plain is not None
    assert smooth is not None
    assert smooth.shape[1] < 12 < plain.shape[1]
    assert length(smooth) < length(plain)
    assert np.allclose(smooth[:, [0, -1]], plain[:, [0, -1]])


def test_starts_and_goals_of_any_form() -> None:
    env_map = Map(5, 5, 0.5)
    paths = [
        AStarPlanner(env_map).planning(start, goal, show_animation=False)
        for start, goal in (([1, 1], (4, 4)), (np.array([[1.0], [1.0], [0.3]]), np.array([4.0, 4.0, 1.0])))
    ]
    assert paths[0] is not None
    assert np.array_equal(paths[0], paths[1])
    with pytest.raises(ValueError, match="two finite numbers"):
        AStarPlanner(env_map).planning([1], [4, 4])


@pytest.mark.parametrize("planner_class", [AStarPlanner, JPSPlanner])
@pytest.mark.parametrize("grid", [None, np.zeros((100, 80))])
def test_a_written_resolution_holds_for_the_planner_alone(planner_class: type[AStarPlanner], grid: Any) -> None:
    env_map = Map(10, 8, 0.1, grid=grid)
    planner = planner_class(env_map)
    planner.resolution = 0.5
    assert (planner.resolution, planner.x_width, planner.y_width, env_map.resolution) == (0.5, 20, 16, 0.1)
    path = planner.planning([1, 1], [9, 7], show_animation=False)
    assert path is not None
    assert path[:, -1].tolist() == [1.25, 1.25], "the middle of a cell of 0.5 m"
    assert planner_class(env_map).x_width == 100


@pytest.mark.parametrize("planner_class", [AStarPlanner, JPSPlanner])
def test_written_numbers_of_cells_hold_until_the_resolution_is_written(planner_class: type[AStarPlanner]) -> None:
    planner = planner_class(Map(10, 8, 0.1))
    planner.x_width, planner.y_width = 40, 32
    assert (planner.resolution, planner.x_width, planner.y_width) == (0.25, 40, 32)
    path = planner.planning([1, 1], [9, 7], show_animation=False)
    assert path is not None
    assert path[:, -1].tolist() == [1.125, 1.125]
    planner.resolution = 1
    assert (planner.x_width, planner.y_width) == (10, 8)


@pytest.mark.parametrize(
    ("name", "value"), [("resolution", 0), ("resolution", math.inf), ("x_width", 0), ("y_width", 2.5)]
)
def test_cells_that_are_none_are_refused(name: str, value: float) -> None:
    with pytest.raises(ValueError, match="positive"):
        setattr(AStarPlanner(Map(10, 8, 0.1)), name, value)


DISC = shapely.Point(0, 0).buffer(0.3)
CORNER = shapely.Polygon([(-0.3, -0.3), (0.5, -0.3), (0.5, 0.0), (0.0, 0.0), (0.0, 0.4), (-0.3, 0.4)])
WALL = [shapely.box(4, -1, 5, 6), shapely.Point(7, 7).buffer(0.8), shapely.LineString([(1, 8), (3, 4)])]


def make(cls: Any, env_map: Map, robot: Any, seed: int = 5, **options: Any) -> Any:
    return cls(env_map, 0.3 if cls is PRMPlanner else robot, seed=seed, **options)


def check(path: NDArray[np.float64], robot: Any, things: list[Any], start: Any, goal: Any) -> None:
    assert np.allclose(path[:, 0], goal)
    assert np.allclose(path[:, -1], start)
    blocked = shapely.union_all(things)
    for a, b in zip(path.T[:-1], path.T[1:], strict=True):
        for t in np.linspace(0, 1, 9):
            x, y = a + (b - a) * t
            moved = shapely.affinity.translate(robot, x, y)
            assert not moved.buffer(-1e-7).intersects(blocked)
            assert shapely.box(0, 0, 10, 10).buffer(1e-6).contains(moved)


@pytest.mark.parametrize("cls", [RRT, RRTStar, InformedRRTStar, PRMPlanner])
def test_valid_and_reproducible(cls: Any) -> None:
    env_map, start, goal = Map(10, 10, 0.1, WALL), (1.0, 1.0), (9.0, 2.0)
    options = {} if cls is PRMPlanner else {"max_iter": 2000}
    paths = []
    for seed in (5, 5, 6):
        planner = make(cls, env_map, DISC, seed, **options)
        path = planner.planning(start, goal, show_animation=False)
        assert path is not None
        check(path, DISC, WALL, start, goal)
        assert planner.end.cost == pytest.approx(np.linalg.norm(np.diff(path, axis=1), axis=0).sum())
        assert planner.node_list
        paths.append(path)
    assert np.array_equal(paths[0], paths[1])
    assert not np.array_equal(paths[0], paths[2])


@for_all(30, st.integers(0, 1000), st.sampled_from([RRT, RRTStar, InformedRRTStar]), st.booleans())
def test_any_body(seed: int, cls: Any, smooth: bool) -> None:
    rng = np.random.default_rng(seed)
    things = [
        shapely.affinity.rotate(shapely.box(x, y, x + w, y + 0.3), float(turn))
        for x, y, w, turn in rng.uniform((1, 1, 0.3, 0), (8, 8, 2, 180), (6, 4))
    ]
    start, goal = (0.6, 0.6), (9.2, 9.2)
    path = cls(Map(10, 10, 0.1, things), CORNER, seed=seed, smooth=smooth).planning(start, goal, show_animation=False)
    if path is not None:
        check(path, CORNER, things, start, goal)


def test_stars_are_shorter() -> None:
    env_map = Map(10, 10, 0.1, WALL)
    costs = {}
    for cls in (RRT, RRTStar, InformedRRTStar):
        options = {"search_until_max_iter": True, "connect_circle_dist": 20.0} if cls is not RRT else {}
        ends = []
        for seed in range(6):
            planner = cls(env_map, DISC, max_iter=1500, seed=seed, **options)
            planner.planning((1, 1), (9, 2), show_animation=False)
            ends.append(planner.end.cost)
        costs[cls] = np.mean(ends)
    shortest = np.hypot(4 - 0.3 - 1, 6.3 - 1) + 1 + np.hypot(9 - 5.3, 6.3 - 2)  # about
    assert shortest * 0.97 < costs[InformedRRTStar] <= costs[RRTStar] < costs[RRT]


def test_costs_of_a_rewired_tree() -> None:
    planner = RRTStar(Map(10, 10, 0.1, WALL), DISC, max_iter=800, connect_circle_dist=20.0, seed=1)
    planner.planning((1, 1), (9, 2), show_animation=False)
    for node in planner.node_list:
        if node.parent is not None:
            step = np.hypot(node.x - node.parent.x, node.y - node.parent.y)
            assert node.cost == pytest.approx(node.parent.cost + step)


@pytest.mark.parametrize("cls", [RRT, PRMPlanner])
def test_without_a_path_samples_find_none(cls: Any) -> None:
    walled = Map(10, 10, 0.1, [shapely.box(4, -1, 5, 11)])
    assert make(cls, walled, DISC).planning((1, 1), (9, 2), show_animation=False) is None
    assert make(cls, Map(10, 10, 0.1, WALL), DISC).planning((1, 1), (4.5, 2), show_animation=False) is None


def test_repeated_calls_draw_anew() -> None:
    planner = RRT(Map(10, 10, 0.1, WALL), DISC, seed=1, max_iter=2000)
    first, second = (planner.planning((1, 1), (9, 2), show_animation=False) for _ in range(2))
    assert first is not None
    assert second is not None
    assert first.shape != second.shape or not np.allclose(first, second)


def test_prm_takes_a_generator() -> None:
    env_map = Map(10, 10, 0.1, WALL)
    paths = [
        PRMPlanner(env_map, 0.3).planning((1, 1), (9, 2), np.random.default_rng(4), show_animation=False)
        for _ in range(2)
    ]
    assert paths[0] is not None
    assert np.array_equal(paths[0], paths[1])
