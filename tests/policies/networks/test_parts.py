"""Observation parts: numbers worked by hand, bounds, frames, and rows that do not depend on one another."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, get_args

import numpy as np
import pytest
from pydantic import ValidationError

from irsim.policies import Needs, Observations, Scan
from irsim.policies.networks.errors import PolicyInputError
from irsim.policies.networks.layout import Layout, layout_bounds, layout_needs, layout_shapes, observe
from irsim.policies.networks.parts import neighbors, robot
from irsim.policies.networks.parts._options import PARTS
from tests.policies.networks.observed import Grid, assert_same_in_any_company, moved, observations, people, rows

ALL: dict[str, dict[str, Any]] = {
    "goal": {"features": list(get_args(robot.GoalFeature))},
    "own": {"features": list(get_args(robot.OwnFeature)), "controls": 3},
    "scan": {"sectors": 7},
    "neighbors": {"features": list(get_args(neighbors.Feature)), "count": 4, "range": 3.0},
    "map": {"cells": 5, "size": 2.0},
    "rvo_cones": {"nearest": 5},
    "rvo_self": {},
    "self_state": {"heading": "wrapped"},
}
"""Every part, with all of its features."""
WITHOUT_FRAME = ("scan", "rvo_cones", "rvo_self", "self_state")


def layout(**parts: Any) -> Layout:
    return Layout.model_validate({"parts": [{"name": name, **options} for name, options in parts.items()]})


def numbers(seen: Observations, name: str, **options: Any) -> Any:
    return observe(layout(**{name: options}), seen)[name].array


def alone(pose: Any, **changed: Any) -> Observations:
    """One robot at a pose, without the parts that a test does not give."""
    one = rows(observations(), [1])
    return replace(one, pose=np.array([pose], float), neighbors=None, scan=None, maps=None, **changed)


def test_all_parts_are_tried_here() -> None:
    assert sorted(ALL) == PARTS.names()


@pytest.mark.parametrize("frame", ["own", "goal", "world"])
def test_a_robot_observes_the_same_alone_and_in_any_company(frame: str) -> None:
    framed = {name: {**options, "frame": frame} for name, options in ALL.items() if name not in WITHOUT_FRAME}
    chosen = layout(**{**ALL, **framed})
    for count in (1, 2, 3, 9, 33):
        whole = observations(count, seed=count)
        for label, value in observe(chosen, whole).items():
            assert_same_in_any_company(lambda seen, label=label: observe(chosen, seen)[label].array, whole)
            if value.mask is not None:
                assert_same_in_any_company(lambda seen, label=label: observe(chosen, seen)[label].mask, whole)


def test_numbers_have_the_declared_shape_and_bounds() -> None:
    chosen = layout(**ALL)
    shapes, bounds = layout_shapes(chosen), layout_bounds(chosen)
    for seed in range(5):
        whole = observations(40, seed)
        far = replace(whole, velocity=whole.velocity * 100, radius=whole.radius * 100, pose=whole.pose * 100)
        for seen in (whole, replace(far, control=far.control * 9)):
            for label, value in observe(chosen, seen).items():
                low, high = bounds[label]
                assert value.shape == shapes[label]
                assert low.shape == value.array.shape[1:] == high.shape
                assert ((value.array >= low) & (value.array <= high)).all(), label


def test_own_frame_and_goal_frame_do_not_see_where_the_world_lies() -> None:
    whole = observations(30)
    for frame in ("own", "goal"):
        chosen = layout(**{name: {**ALL[name], "frame": frame} for name in ("goal", "own", "neighbors")})
        there = observe(chosen, moved(whole, 1.1, (3.0, -2.0)))
        for label, value in observe(chosen, whole).items():
            np.testing.assert_allclose(there[label].present(), value.present(), atol=1e-12)


def test_goal_as_seen_from_the_robot() -> None:
    seen = alone([1, 1, math.pi / 2], goal=np.array([[1.0, 3.0, math.pi]]))
    features = ["distance", "nearness", "cos", "sin", "x", "y", "heading_cos", "heading_sin", "threshold", "present"]
    expected = [0.5, math.exp(-1), 1, 0, 0.5, 0, 0, 1, 0.075, 1]
    np.testing.assert_allclose(numbers(seen, "goal", features=features, decay=2.0), [expected], atol=1e-15)
    np.testing.assert_allclose(numbers(seen, "goal", frame="world"), [[0.5, 0, 1]], atol=1e-15)
    np.testing.assert_allclose(numbers(seen, "goal", distance_max=1.0), [[1, 1, 0]], atol=1e-15)
    np.testing.assert_allclose(numbers(seen, "goal", distance_max=1.0, clip=False), [[2, 1, 0]], atol=1e-15)


def test_robots_at_their_goal_and_without_one() -> None:
    at = alone([2, 3, 0.7], goal=np.array([[2.0, 3.0, np.nan]]))
    assert numbers(at, "goal", features=["distance", "cos", "sin", "heading_cos"]).tolist() == [[0, 1, 0, 0]]
    without = alone([2, 3, 0.7], goal=np.full((1, 3), np.nan))
    assert not numbers(without, "goal", **ALL["goal"]).any()


def test_the_robot_itself() -> None:
    limits = {"low": np.array([[-0.2, -3.0, 0.0]]), "high": np.array([[1.0, 3.0, 0.0]])}
    motion = {"velocity": np.array([[0.0, 0.6]]), "yaw_rate": np.array([-6.0]), "control": np.array([[0.6, -6.0, 0.0]])}
    seen = alone([0, 0, math.pi / 2], **motion, **limits)
    np.testing.assert_allclose(numbers(seen, "own", features=["vx", "vy", "yaw_rate"]), [[0.6, 0, -1]], atol=1e-15)
    np.testing.assert_allclose(numbers(seen, "own", features=["control"]), [[1 / 3, -1]])
    np.testing.assert_allclose(numbers(seen, "own", features=["control"], clip=False), [[1 / 3, -2]])
    np.testing.assert_allclose(numbers(seen, "own", features=["low", "high"]), [[-0.02, -0.3, 0.1, 0.3]])
    endless = replace(seen, low=np.full((1, 3), -np.inf), high=np.full((1, 3), np.inf))
    assert numbers(endless, "own", features=["control"]).tolist() == [[0, 0]]


def test_sectors_of_a_scan_hold_the_shortest_range() -> None:
    scan = Scan(np.array([[4.0, 1, 8, 8, 2, 6, 3]]), np.linspace(-1, 1, 7), 8.0)
    seen = replace(alone([0, 0, 0]), scan=scan)
    np.testing.assert_array_equal(numbers(seen, "scan", sectors=3), np.array([[1, 8, 2]]) / 8)
    np.testing.assert_array_equal(numbers(seen, "scan", sectors=7, range_max=4.0), [[1, 0.25, 1, 1, 0.5, 1, 0.75]])
    np.testing.assert_array_equal(numbers(seen, "scan", sectors=1, nearness=True), [[0.875]])
    with pytest.raises(PolicyInputError, match="8 sectors of a lidar, and the lidar has 7 beams"):
        numbers(seen, "scan", sectors=8)
    with pytest.raises(PolicyInputError, match="expects beams from -2 to 2 rad, and the lidar has -1 to 1 rad"):
        numbers(seen, "scan", sectors=3, angles=[-2.0, 2.0])


def test_neighbors_relative_to_the_robot() -> None:
    pose, first = [[[0.0, 1.0, math.pi / 2], [0.0, -3.0, 0.0], [0.0] * 3]], [[True, False, False]]
    others = people((0, 1, 0, 1), (0, -3), count=3, pose=pose, radius=[[0.3, 0.5, 0.0]], arrived=first, robot=first)
    own = {"velocity": np.array([[0.0, 0.5]]), "radius": np.array([0.2]), "goal": np.array([[0.0, 2.0, 0.0]])}
    seen = replace(alone([0, 0, math.pi / 2], **own), neighbors=others)
    features = ["x", "y", "vx", "vy", "heading_cos", "radius", "radii", "gap", "nearness", "goal_distance", "arrived"]
    expected = [
        [0.25, 0, 0.5, 0, 1, 0.3, 0.5, 0.125, math.exp(-0.5), 0.25, 1],
        [-0.75, 0, -0.5, 0, 0, 0.5, 0.7, 2.3 / 4, math.exp(-2.3), 1, 0],
        [0] * 11,
    ]
    np.testing.assert_allclose(numbers(seen, "neighbors", features=features, count=3), [expected], atol=1e-15)
    last = observe(layout(neighbors={"features": ["x"], "count": 3, "nearest_last": True, "range": 1.0}), seen)
    assert last["neighbors"].array.tolist() == [[[0], [0], [0.25]]]
    assert last["neighbors"].mask.tolist() == [[False, False, True]]
    still = numbers(seen, "neighbors", features=["vx"], count=2, relative_velocity=False)
    np.testing.assert_allclose(still, [[[1], [0]]], atol=1e-15)
    with pytest.raises(PolicyInputError, match="observes extents of neighbors"):
        numbers(seen, "neighbors", features=["extent"], count=1)
    extents = replace(others, extent=np.array([[0.2, 0.5, 0]]), own_extent=np.array([[0.1, 0.2, 0]]))
    features = ["extent", "own_extent", "extent_gap"]
    reaching = numbers(replace(seen, neighbors=extents), "neighbors", features=features, count=2)
    np.testing.assert_allclose(reaching, [[[0.2, 0.1, 0.7 / 4], [0.5, 0.2, 2.3 / 4]]], atol=1e-15)
    with pytest.raises(PolicyInputError, match="observes 4 neighbors, not 3"):
        numbers(seen, "neighbors", count=4)


def test_picture_of_the_map_turns_with_the_robot() -> None:
    grid = np.zeros((40, 40), dtype=bool)
    grid[30:32, 20] = True  # ahead of a robot in the middle that looks along x
    world = Grid(grid, (0.0, 0.0), 0.1)
    ahead = numbers(replace(alone([2.0, 2.05, 0]), maps=(world,)), "map", cells=3, size=3.0)
    assert ahead.reshape(3, 3).tolist() == [[0, 0, 0], [0, 0, 0], [0, 1, 0]]
    left = numbers(replace(alone([2.0, 2.05, -math.pi / 2]), maps=(world,)), "map", cells=3, size=3.0)
    assert left.reshape(3, 3).tolist() == [[0, 0, 0], [0, 0, 1], [0, 0, 0]]
    edge = replace(alone([0.0, 2.0, 0]), maps=(world,))
    assert numbers(edge, "map", cells=2, size=1.0).tolist() == [[1, 1, 0, 0]]
    assert numbers(edge, "map", cells=2, size=1.0, outside_occupied=False).tolist() == [[0, 0, 0, 0]]


def test_a_layout_declares_what_all_of_its_parts_need() -> None:
    near = {"name": "neighbors", "label": "near", "count": 3, "range": 1.0}
    far = {"name": "neighbors", "label": "far", "count": 8, "range": 5.0}
    needs = layout_needs(Layout.model_validate({"parts": [near, far, {"name": "scan"}]}))
    assert needs == Needs(neighbors=8, neighbor_range=5.0, scan=True)
    assert layout_needs(layout(map={"cells": 10, "size": 4.0})).map_resolution == 0.2
    assert layout_needs(layout(goal={})) == layout_needs(layout(own={}))


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ([{"name": "gaol"}], "'gaol' is not a part"),
        ([{"name": "goal"}, {"name": "goal"}], "two parts are called 'goal'"),
        ([{"name": "goal", "features": ["x", "x"]}], "'x' is listed twice"),
        ([{"name": "goal", "distance_max": 0}], "greater than 0"),
        ([{"name": "own", "range": 3}], "Extra inputs"),
        ([{"name": "neighbors"}, {"name": "neighbors", "label": "a", "static": True}], "'static' differs between two"),
        ([], "at least 1 item"),
    ],
)
def test_bad_layouts_are_refused(parts: Any, message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        Layout.model_validate({"parts": parts})


def test_the_robot_itself_in_the_frame_of_its_goal() -> None:
    limit = np.array([[1.5, 3.0, 0.0]])
    seen = alone([1, 1, 0.5], goal=np.array([[1.0, 4.0, np.nan]]), velocity=np.array([[0.4, 0.3]]), high=limit)
    seen = replace(seen, radius=np.array([0.25]))
    np.testing.assert_allclose(numbers(seen, "self_state"), [[3, 1.5, 0, 0.25, 0.3, -0.4]], atol=1e-15)
    turned = [[3, 1.5, 0.5 - math.pi / 2, 0.25, 0.3, -0.4]]
    np.testing.assert_allclose(numbers(seen, "self_state", heading="unwrapped"), turned, atol=1e-15)
    away = replace(seen, pose=np.array([[1.0, 1, -2.0]]))
    assert numbers(away, "self_state", heading="unwrapped")[0, 2] == pytest.approx(-2 - math.pi / 2)
    assert numbers(away, "self_state", heading="wrapped")[0, 2] == pytest.approx(1.5 * math.pi - 2)
    without = replace(seen, goal=np.full((1, 3), np.nan), pose=np.array([[1.0, 1, 0]]))
    np.testing.assert_allclose(numbers(without, "self_state"), [[0, 1.5, 0, 0.25, 0.4, 0.3]], atol=1e-15)
    with pytest.raises(PolicyInputError, match="the largest speed"):
        numbers(replace(seen, high=np.full((1, 3), np.inf)), "self_state")
