"""The judge on motions made by hand, and beside shapely."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import shapely

from tests.avoidance.judge import Judge, Verdict, at_ends, at_rest, within_steps

BAR = [(-0.01, -1.0), (0.01, -1.0), (0.01, 1.0), (-0.01, 1.0)]
FAR = [(9.0, 9.0), (-9.0, 9.0)]


def judged(path: Any, goals: Any = FAR, walls: Any = (), *, loop: bool = False) -> Verdict:
    """The verdict about robots with a radius of 0.2 m."""
    judge = Judge(goals, list(walls), radius=0.2, threshold=0.2, dt=0.1, loop=loop)
    verdict = judge.verdict(path)
    assert judge.ended(path) == (verdict.outcome == "c" or (verdict.outcome == "a" and not loop))
    return verdict


def test_those_that_jump_through_each_other_touch_between_steps() -> None:
    path = [[(-0.5, 0.1), (0.5, -0.1)], [(0.5, 0.1), (-0.5, -0.1)]]
    verdict = judged(path, FAR, [])
    assert (verdict.outcome, verdict.between) == ("t", 1)
    assert verdict.depth_m == pytest.approx(0.2)  # they pass at 0.2 m, their radii are 0.4 m together
    assert verdict.touched
    assert not verdict.success


def test_an_overlap_at_the_end_of_a_step_ends_the_episode() -> None:
    path = [[(0.0, 0.0), (1.0, 0.0)], [(0.0, 0.0), (0.5, 0.0)], [(0.0, 0.0), (0.3, 0.0)], [(9.0, 9.0), (-9.0, 9.0)]]
    verdict = judged(path, FAR, [])
    assert (verdict.outcome, verdict.seconds, verdict.between) == ("c", 0.2, 0)
    assert verdict.depth_m == pytest.approx(0.1)


@pytest.mark.parametrize(("gap", "outcome"), [(-1e-7, "t"), (-1e-5, "c"), (1e-7, "t")])
def test_rounding_is_no_contact(gap: float, outcome: str) -> None:
    path = [[(0.0, 0.0), (1.0, 0.0)], [(0.0, 0.0), (0.4 + gap, 0.0)]]
    assert judged(path, FAR, []).outcome == outcome


def test_all_have_arrived_once_each_is_near_its_goal() -> None:
    path = [[(0.0, 0.0), (3.0, 0.0)], [(0.9, 0.0), (3.0, 0.0)], [(0.9, 0.0), (2.1, 0.0)], [(0.9, 0.0), (1.0, 0.0)]]
    verdict = judged(path, [(1.0, 0.0), (2.0, 0.0)])
    assert (verdict.outcome, verdict.seconds, verdict.success) == ("a", 0.2, True)


def test_an_arrival_after_a_pass_is_no_success() -> None:
    path = [[(-0.5, 0.1), (0.5, -0.1)], [(0.5, 0.1), (-0.5, -0.1)]]
    verdict = judged(path, [(0.5, 0.1), (-0.5, -0.1)])
    assert (verdict.outcome, verdict.success) == ("a", False)


def test_a_thin_wall_between_two_poses_is_a_contact_between_steps() -> None:
    verdict = judged([[(-0.3, 0.0)], [(0.3, 0.0)]], FAR[:1], [BAR])
    assert (verdict.outcome, verdict.between > 0) == ("t", True)


def test_a_corner_is_rounded_without_a_contact() -> None:
    corner = np.array(BAR[2])
    beside = [[corner + 0.2001 * np.array([np.cos(a), np.sin(a)])] for a in np.linspace(0.0, np.pi / 2, 200)]
    verdict = judged(beside, FAR[:1], [BAR])
    assert (verdict.outcome, verdict.between) == ("t", 0)


def test_back_and_forth_needs_a_crossing_and_no_standstill() -> None:
    there = [[(0.1 * k, 0.0)] for k in range(11)]
    back = there[::-1]
    assert judged([*there, *back], [(1.0, 0.0)], [], loop=True).outcome == "a"
    assert judged(there[:5], [(1.0, 0.0)], [], loop=True).outcome == "t"
    stuck = [*there, *([[(1.0, 0.0)]] * 60)]
    assert at_rest(stuck, 0.1)
    assert judged(stuck, [(1.0, 0.0)], [], loop=True).outcome == "t"


def test_distances_within_steps_are_those_of_shapely() -> None:
    draw = np.random.default_rng(5)
    for _ in range(100):
        path = draw.uniform(-2, 2, (2, 2, 2))
        ring = shapely.convex_hull(shapely.MultiPoint(draw.uniform(-1, 1, (6, 2))))
        corners = np.asarray(ring.exterior.coords)[:-1]
        ends, within = at_ends(path, [corners], 0.2), within_steps(path, [corners], 0.2)
        edges = shapely.LineString([*corners, corners[0]])
        for robot in range(2):
            wanted = shapely.LineString(path[:, robot]).distance(edges) - 0.2
            columns = slice(1 + robot * len(corners), 1 + (robot + 1) * len(corners))
            assert within[0, columns].min() == pytest.approx(wanted, abs=1e-12)
            for k in range(2):
                assert ends[k, columns].min() == pytest.approx(shapely.Point(path[k, robot]).distance(edges) - 0.2)
        apart = shapely.LineString(path[:, 0] - path[:, 1])
        assert within[0, 0] == pytest.approx(apart.distance(shapely.Point(0, 0)) - 0.4, abs=1e-12)
