"""Observations of RL-RVO: numbers worked by hand, and a plain reference of its formulas."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from irsim.policies import Observations
from irsim.policies.networks.errors import PolicyInputError
from irsim.policies.networks.layout import observe
from irsim.policies.networks.values import Value
from tests.policies.networks.observed import observations, people, rows
from tests.policies.networks.test_parts import alone, layout, numbers


def seen(*others: tuple[float, ...], **changed: Any) -> Observations:
    """A robot of radius 0.2 in the origin, and others of its size with x, y, vx and vy, nearest first."""
    basis = {"velocity": np.zeros((1, 2)), "radius": np.array([0.2]), "commanded": np.zeros((1, 2))}
    return replace(alone([0, 0, 0]), **{**basis, **changed, "neighbors": people(*others, radius=0.2)})


def cones(what: Observations, **options: Any) -> Value:
    return observe(layout(rvo_cones={"nearest": what.neighbors.mask.shape[1], **options}), what)["rvo_cones"]


def test_a_robot_ahead_that_comes_closer() -> None:
    ahead = seen((1.0, 0.0, -1.0, 0.0), velocity=np.array([[0.5, 0.0]]), commanded=np.array([[0.75, 0.0]]))
    observed = cones(ahead)
    # 2 (0.75, 0) - (-1, 0) - (0.5, 0) = (2, 0) closes the gap of 1 - (0.2 + 0.1 + 0.2) m in 0.25 s; asin(0.5) = 30 deg
    assert observed.array[0, :4].tolist() == [[0] * 8] * 4
    np.testing.assert_array_equal(observed.array[0, 4], [-0.25, 0, 0.87, 0.5, 0.87, -0.5, 0.8, 2.22])
    assert observed.mask.tolist() == [[False, False, False, False, True]]
    exact = cones(ahead, decimals=None).array[0, 4]
    root = math.sqrt(0.75)
    np.testing.assert_allclose(exact, [-0.25, 0, root, 0.5, root, -0.5, 0.8, 1 / 0.45], rtol=1e-15)


def test_one_that_stands_still_has_a_velocity_obstacle_at_its_own_velocity() -> None:
    still = seen((2.0, 0.0, 0.0, 0.0), velocity=np.array([[0.5, 0.3]]), commanded=np.array([[1.0, 0.0]]))
    apex_and_end = cones(still).array[0, 4, [0, 1, 6, 7]]
    assert apex_and_end.tolist() == [0, 0, 1.8, round(1 / 1.7, 2)]  # 1.5 m at 1 m/s, not at 2 - 0.5 m/s


def test_what_is_outside_the_cone_or_later_than_the_horizon_is_not_urgent() -> None:
    away = seen((2.0, 0.0, 0.0, 0.0), commanded=np.array([[-1.0, 0.0]]))
    slow = seen((2.0, 0.0, 0.0, 0.0), commanded=np.array([[0.25, 0.0]]))
    assert cones(away).array[0, 4, 7] == 0
    assert cones(slow).array[0, 4, 7] == 0
    assert cones(slow, horizon=6.5).array[0, 4, 7] == round(1 / 6.2, 2)
    assert cones(slow, velocity="present").array[0, 4, 7] == 0


def test_discs_that_overlap_collide_now_and_their_cone_is_a_half_plane() -> None:
    touching = seen((0.3, 0.0, 0.0, 0.0), commanded=np.array([[0.1, 0.0]]))
    np.testing.assert_array_equal(cones(touching).array[0, 4], [0, 0, 0, 1, 0, -1, 0.1, 5])


def test_a_robot_that_sees_nobody_sees_one_member_of_zeros() -> None:
    far = seen((5.0, 0.0, -1.0, 0.0))
    padded, without = cones(far), cones(far, zero_row=False)
    assert not padded.array.any()
    assert padded.mask.tolist() == [[False, False, False, False, True]]
    assert not without.mask.any()
    assert cones(far, range=5.0).array[0, 4, 6] == 4.8  # between centers, not between discs


def test_the_most_urgent_ones_are_kept_and_come_last() -> None:
    wanted = np.array([[1.0, 0.0]])
    several = seen((0.0, 1.0), (1.5, 0.0), (2.5, 0.0), (0.0, -3.0), commanded=wanted)
    beside, ahead, nearer_ahead = cones(several, count=3).array[0, :, 6]  # the farther one beside is left out
    assert (beside, ahead, nearer_ahead) == (0.8, 2.3, 1.3)


def test_the_robot_itself() -> None:
    goal, limits = np.array([[3.0, 4.0, np.nan]]), np.array([[1.5, 3.0, 0.0]])
    one = alone([0, 0, 2.0], velocity=np.array([[0.123, -0.456]]), radius=np.array([0.2]), goal=goal, high=limits)
    assert numbers(one, "rvo_self").tolist() == [[0.12, -0.46, 0.9, 1.2, 2.0, 0.3]]
    assert numbers(one, "rvo_self", speed=1.0, margin=0.0)[0, 2:].tolist() == [0.6, 0.8, 2.0, 0.2]
    near = replace(one, goal=np.array([[0.2, 0.1, np.nan]]))
    assert numbers(near, "rvo_self")[0, 2:4].tolist() == [0, 0]
    endless = replace(one, high=np.full((1, 3), np.inf))
    np.testing.assert_allclose(numbers(endless, "rvo_self")[0, 2:4], [0.6, 0.8])


def test_observations_without_the_velocity_commanded_last_are_refused() -> None:
    without = replace(seen((1.0, 0, 0, 0)), commanded=None)
    with pytest.raises(PolicyInputError, match="commanded last"):
        cones(without)
    cones(without, velocity="present")
    with pytest.raises(PolicyInputError, match="observes 9 neighbors, not 1"):
        cones(without, nearest=9)


def reference(what: Observations, b: int, margin: float, decimals: int | None) -> list[list[float]]:
    """The members that are present, from the formulas of the paper, with angles."""
    n, members = what.neighbors, []
    (x, y), (vx, vy), (ax, ay) = what.pose[b, :2], what.velocity[b], what.commanded[b]
    for k in np.flatnonzero(n.mask[b]):
        (mx, my), (mvx, mvy), mr = n.position[b, k], n.velocity[b, k], n.radius[b, k]
        distance, reach = math.hypot(mx - x, my - y), what.radius[b] + margin + mr
        if distance > 4.0:
            continue
        still = mvx == 0 and mvy == 0
        middle, half = math.atan2(my - y, mx - x), math.asin(reach / max(distance, reach))
        left, right = middle + half, middle - half
        px, py = (mvx, mvy) if still else ((vx + mvx) / 2, (vy + mvy) / 2)
        rx, ry = (ax - mvx, ay - mvy) if still else (2 * ax - vx - mvx, 2 * ay - vy - mvy)
        turn = math.remainder(math.atan2(ay - py, ax - px) - middle, 2 * math.pi)
        time = math.inf
        if abs(turn) <= half:
            a, c = rx * rx + ry * ry, distance * distance - reach * reach
            b2 = rx * (x - mx) + ry * (y - my)
            if c <= 0:
                time = 0.0
            elif b2 * b2 > a * c and b2 < 0:
                time = (-b2 - math.sqrt(b2 * b2 - a * c)) / a
        urgency = 1 / ((time if time < 5 else math.inf) + 0.2)
        legs = [math.cos(left), math.sin(left), math.cos(right), math.sin(right)]
        members.append([px, py, *legs, distance - mr, urgency])
    members.sort(key=lambda cone: (cone[7], -cone[6]))
    kept = members[-5:]
    return kept if decimals is None else np.round(kept, decimals).tolist()


@pytest.mark.parametrize("decimals", [None, 2])
def test_many_scenes_agree_with_the_reference(decimals: int | None) -> None:
    tried = timed = 0
    for seed in range(20):
        whole = observations(30, seed, neighbors=8)
        velocity = np.where(whole.neighbors.index[:, :, None] % 3 == 0, 0.0, whole.neighbors.velocity)
        whole = replace(whole, neighbors=replace(whole.neighbors, velocity=velocity))
        observed = cones(whole, decimals=decimals)
        for b in range(len(whole)):
            expected = reference(whole, b, 0.1, decimals)
            present = observed.array[b][observed.mask[b]]
            if expected:
                np.testing.assert_allclose(present, expected, atol=1e-12)
            else:
                assert present.tolist() == [[0] * 8]
            assert cones(rows(whole, [b]), decimals=decimals).array.tobytes() == observed.array[b : b + 1].tobytes()
            tried += len(expected)
            timed += sum(cone[7] > 0 for cone in expected)
    assert tried > 1000
    assert timed > 100
