"""Social forces: against plain NumPy, and what they must do in simple scenes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import strategies as st

import irsim._core as core
from tests.core import crowd_oracle as oracle
from tests.core.crowds import Crowd
from tests.core.worlds import DRIVES, advanced, circle, decided, kernel, line, obstacle, rectangle, robot
from tests.effort import for_all


def walker(**overrides: Any) -> core.ObjectSpec:
    return robot(
        **{"drive": DRIVES["omni"], "behavior": kernel("sfm"), "vel_max": [2.0] * 3, "vel_min": [-2.0] * 3, **overrides}
    )


def turning(crowd: Crowd, i: int) -> dict[str, float]:
    return {"tolerance": 0.02, "guarantee_time": crowd.dt, "max_rate": crowd.specs[i]["vel_max"][1]}


@pytest.mark.parametrize("drive", DRIVES)
@for_all(40, seed=st.integers(0, 2**32 - 1))
def test_each_object_alone(drive: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    options = kernel(
        "sfm",
        neighbor_threshold=rng.uniform(1, 8),
        lambda_importance=rng.uniform(0, 3),
        gamma=rng.uniform(0.1, 1),
        safety_radius=rng.choice([0.0, 0.3]),
        sigma_obstacle=rng.uniform(0.1, 1),
        vmax=rng.uniform(0.3, 3),
    )
    crowd = Crowd(rng, drive, options)
    core.decide(crowd.world, crowd.state)
    for i in range(crowd.deciders):
        wanted = oracle.sfm(options, crowd.view(i), crowd.dt)
        np.testing.assert_allclose(
            crowd.state.command[i], crowd.control(i, wanted, turning(crowd, i)), rtol=1e-9, atol=1e-9
        )


@pytest.mark.parametrize("drive", DRIVES)
@for_all(40, seed=st.integers(0, 2**32 - 1))
def test_members_of_a_group(drive: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    order = rng.permutation(5).tolist()
    groups = [order[: rng.integers(1, 4)], order[3:]]
    options = kernel(
        "sfm",
        social_groups=groups,
        group_repulsion_threshold=None if rng.random() < 0.5 else rng.uniform(0, 3),
        gaze_vision_angle=rng.uniform(10, 180),
    )
    roles = int(rng.integers(3))
    crowd = Crowd(rng, drive, options, group=5, grouped=True, target_roles=roles)
    core.decide(crowd.world, crowd.state)
    for i in range(crowd.deciders):
        own = next((g for g in groups if i in g), [])
        companions = [
            (np.array(crowd.specs[j]["pose"][:2]), crowd.radius(j) + 0.1) for j in own if j != i and j < crowd.deciders
        ]
        wanted = oracle.sfm(options, crowd.view(i, grouped=True), crowd.dt, companions)
        np.testing.assert_allclose(
            crowd.state.command[i], crowd.control(i, wanted, turning(crowd, i)), rtol=1e-9, atol=1e-9
        )


def test_alone_one_is_pulled_to_the_goal_up_to_its_speed_and_rests_without_one() -> None:
    assert np.abs(advanced(60, walker(control=[1.0, 0.0, 0.0])).control).max() < 1e-5
    fast = decided(walker(goals=[[9.0, 0.0]], control=[1.5, 0.0, 0.0]))
    np.testing.assert_allclose(fast.command[0], [1.5, 0.0, 0.0], atol=1e-12)
    state = decided(walker(goals=[[3.0, 4.0]], control=[0.2, 0.0, 0.0]))
    desired = 1.5 * np.array([0.6, 0.8])
    np.testing.assert_allclose(state.command[0, :2], [0.2, 0.0] + 0.1 * (desired - [0.2, 0.0]) / 0.5, atol=1e-12)


@pytest.mark.parametrize("drive", ["omni", "diff", "omni_angular"])
def test_a_pair_that_is_nearly_head_on_passes(drive: str) -> None:
    state = advanced(
        300,
        walker(drive=DRIVES[drive], parts=[circle(0.15)], pose=[0.0, 0.05, 0.0], goals=[[8.0, 0.05]]),
        walker(drive=DRIVES[drive], parts=[circle(0.15)], pose=[8.0, -0.05, math.pi], goals=[[0.0, -0.05]]),
        until_done=True,
    )
    assert state.arrived.all()
    assert not state.collided.any()


@pytest.mark.parametrize("wall", ["line", "box"])
def test_a_wall_before_the_goal_stops(wall: str) -> None:
    parts = {"line": line((3.0, -3.0), (3.0, 3.0)), "box": rectangle(1.0, 6.0)}[wall]
    pose = [0.0, 0.0, 0.0] if wall == "line" else [3.5, 0.0, 0.0]
    state = advanced(200, walker(goals=[[2.5, 0.0]]), obstacle(parts=[parts], pose=pose))
    assert not state.collided.any()
    assert 1.0 < state.pose[0, 0] < 2.8
    assert abs(state.control[0]).max() < 1e-3


def test_what_is_unobstructed_pushes_only_if_it_is_a_line_or_a_circle() -> None:
    kinds = {"box": rectangle(1.0, 1.0), "circle": circle(0.5), "line": line((0.0, -1.0), (0.0, 1.0))}
    for name, part in kinds.items():
        state = decided(walker(), obstacle(parts=[part], pose=[1.0, 0.3, 0.0], unobstructed=True))
        assert bool(state.command[0].any()) == (name != "box")
