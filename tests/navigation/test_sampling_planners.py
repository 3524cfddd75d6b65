"""Planners that draw samples: valid paths, the same for the same seed, shorter where that is promised."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from irsim.lib.path_planners import RRT, InformedRRTStar, PRMPlanner, RRTStar
from irsim.navigation.map import Map
from tests.effort import examples

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


@settings(max_examples=examples(30))
@given(st.integers(0, 1000), st.sampled_from([RRT, RRTStar, InformedRRTStar]), st.booleans())
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
def test_no_path(cls: Any) -> None:
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
