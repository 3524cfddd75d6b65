"""Reciprocal velocity obstacles: against plain NumPy over the whole grid, and what they must do in simple scenes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import irsim._core as core
from tests.core import crowd_oracle as oracle
from tests.core.crowds import Crowd
from tests.core.oracle import rotation
from tests.core.worlds import DRIVES, PI, advanced, circle, decided, kernel, line, obstacle, rectangle, robot, scene
from tests.effort import for_all

TURNING = {"tolerance": 0.1, "guarantee_time": 0.2, "max_rate": 1.5}


def agent(**overrides: Any) -> core.ObjectSpec:
    return robot(
        **{"drive": DRIVES["omni"], "behavior": kernel("rvo"), "vel_max": [1.5] * 3, "vel_min": [-1.5] * 3, **overrides}
    )


def expected(
    crowd: Crowd, i: int, view: oracle.View, velocity: np.ndarray, discs_or_lines: bool, walls: oracle.Walls
) -> np.ndarray:
    """The control of the drive for the velocity that was picked. Near walls it leaves no small error."""
    if str(crowd.drives[i]).startswith("omni"):
        return crowd.control(i, velocity, TURNING)
    turning = {**TURNING, "tolerance": 0.0, "min_speed": 1e-3} if walls else TURNING
    if np.linalg.norm(velocity) <= turning.get("min_speed", 0.02):
        return crowd.control(i, np.zeros(2) if discs_or_lines else view.desired, turning, fastest=0.0)
    heading = rotation(crowd.specs[i]["pose"][2]) @ (1.0, 0.0)
    rolling = max(float(velocity @ heading), 0.2 * float(np.linalg.norm(velocity)))
    times = [oracle.time_to_wall(view, a, b, heading * rolling) for a, b in walls]
    return crowd.control(i, velocity, turning, min([math.inf, *(rolling * t for t in times if t < 1.0)]))


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("mode", ["rvo", "hrvo", "vo"])
@for_all(8, seed=st.integers(0, 2**32 - 1))
def test_the_best_of_all_samples(drive: str, mode: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    options = kernel(
        "rvo",
        mode=mode,
        vxmax=rng.uniform(0.2, 0.8),
        vymax=rng.uniform(0.2, 0.8),
        acce=rng.uniform(0.1, 0.4),
        factor=rng.uniform(0, 3),
        neighbor_threshold=rng.uniform(1, 5),
    )
    crowd = Crowd(rng, drive, options)
    core.decide(crowd.world, crowd.state)
    for i in range(crowd.deciders):
        view = crowd.view(i)
        candidates = oracle.rvo(options, view)
        seen = bool(view.discs or [1 for a, b in view.lines if np.linalg.norm(b - a) >= 1e-6])
        good = [np.array(c[1:]) for c in candidates if c[0] - candidates[0][0] < 1e-9]
        walls = oracle.rvo_walls(options, view)[0]
        answers = [expected(crowd, i, view, w, seen, walls) for w in good]
        gaps = [np.abs(crowd.state.command[i] - answer).max() for answer in answers]
        assert min(gaps) < 1e-6, (i, candidates[0], answers[0], crowd.state.command[i])


@pytest.mark.parametrize(
    ("options", "command"),
    [
        ({"goals": [[3.0, 4.0]]}, [0.9, 0.95]),  # the sample nearest to the desired velocity of ..., 0.85, 0.9, 0.95
        ({"goals": [[9.0, 0.0]], "control": [1.5, 0.0, 0.0], "behavior": kernel("rvo", vxmax=0.4, acce=0.2)}, [0.4, 0]),
        ({"goals": [[-5.0, 0.1]], "drive": DRIVES["diff"], "behavior": kernel("rvo", acce=0.001)}, [0.0, 1.5]),
    ],
    ids=["nearest sample", "braking to its limits", "turning in place"],
)
def test_alone_it_chooses(options: dict[str, Any], command: list[float]) -> None:
    np.testing.assert_allclose(decided(agent(**options)).command[0, :2], command, atol=1e-9)


@pytest.mark.parametrize("mode", ["rvo", "hrvo", "vo"])
@pytest.mark.parametrize("drive", DRIVES)
def test_a_head_on_pair_passes(drive: str, mode: str) -> None:
    behavior = kernel("rvo", mode=mode, acce=0.5, neighbor_threshold=6.0)
    limits = {"vel_max": [1.0, 1.0, 1.0], "vel_min": [-1.0] * 3, "behavior": behavior, "goal_threshold": 0.3}
    state = advanced(
        400,
        agent(drive=DRIVES[drive], pose=[0.0, 0.02, 0.0], goals=[[8.0, 0.0]], **limits),
        agent(drive=DRIVES[drive], pose=[8.0, 0.0, PI], goals=[[0.0, 0.0]], **limits),
        until_done=True,
    )
    assert not state.collided.any()
    assert state.arrived.all()


def test_a_circle_in_the_way_is_gone_round() -> None:
    state = advanced(
        200, agent(goals=[[6.0, 0.0]]), obstacle(parts=[circle(0.5)], pose=[3.0, 0.1, 0.0]), until_done=True
    )
    assert state.arrived[0]
    assert not state.collided.any()


@pytest.mark.parametrize("drive", DRIVES)
def test_a_wall_ahead_stops_if_there_is_no_way_past(drive: str) -> None:
    state = advanced(
        200,
        agent(drive=DRIVES[drive], goals=[[6.0, 0.0]]),
        obstacle(parts=[rectangle(0.2, 7.9)], pose=[3.0, 0.0, 0.0]),
        obstacle(parts=[line((-2.0, -4.0), (4.0, -4.0), (4.0, 4.0), (-2.0, 4.0), (-2.0, -4.0))]),
        mode=1,
    )
    assert not state.collided[0]
    assert 1.0 < state.pose[0, 0] < 2.8
    assert abs(state.pose[0, 1]) < 3.8


@pytest.mark.parametrize("drive", DRIVES)
def test_along_a_wall_one_drives_at_full_speed(drive: str) -> None:
    """As near as the padding allows: a wall blocks only velocities that lead into it."""
    state = advanced(
        40,
        agent(drive=DRIVES[drive], pose=[0.0, 0.0, 0.0], goals=[[8.0, 0.0]], control=[1.0, 0.0, 0.0]),
        obstacle(parts=[rectangle(12.0, 0.2)], pose=[3.0, 0.41, 0.0]),
    )
    assert state.pose[0, 0] > 4.5
    assert not state.collided.any()


def room(width: float, height: float, thickness: float = 0.2) -> list[core.ObjectSpec]:
    return [obstacle(parts=[rectangle(width, thickness)], pose=[width / 2, y, 0.0]) for y in (0.0, height)] + [
        obstacle(parts=[rectangle(thickness, height)], pose=[x, height / 2, 0.0]) for x in (0.0, width)
    ]


@pytest.mark.parametrize("drive", ["diff", "omni", "omni_angular"])
@pytest.mark.parametrize("seed", range(4))
def test_goals_in_a_closed_room_of_rectangles_are_reached(drive: str, seed: int) -> None:
    """Also close to the walls, from everywhere, with another robot on the way."""
    rng = np.random.default_rng(seed)
    starts = [(1.0, 1.0), (5.0, 1.0), (1.0, 5.0), (5.0, 5.0)]
    goals = [(5.45, 5.0), (0.55, 5.4), (5.4, 0.6), (0.6, 0.6)]
    movers = [
        agent(
            drive=DRIVES[drive],
            pose=[*np.add(start, rng.uniform(-0.3, 0.3, 2)), rng.uniform(-PI, PI)],
            goals=[list(goal)],
            goal_threshold=0.15,
        )
        for start, goal in zip(starts, goals, strict=True)
    ]
    state = advanced(600, *movers, *room(6.0, 6.0), until_done=True)
    assert not state.collided[:4].any()
    assert state.arrived[:4].all()


@pytest.mark.parametrize("drive", DRIVES)
@settings(max_examples=10)
@given(seed=st.integers(0, 2**32 - 1))
def test_walls_are_never_run_into(drive: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    boxes = [
        obstacle(parts=[rectangle(*rng.uniform(0.3, 1.5, 2))], pose=[*rng.uniform(1.5, 6.5, 2), rng.uniform(-PI, PI)])
        for _ in range(4)
    ]
    mover = agent(
        drive=DRIVES[drive],
        pose=[*rng.uniform(0.4, 1.0, 2), rng.uniform(-PI, PI)],
        goals=[rng.uniform(0.5, 7.5, 2).tolist()],
        wander=True,
        range_low=[0.4, 0.4, -PI],
        range_high=[7.6, 7.6, PI],
    )
    world, state = scene(mover, *boxes, *room(8.0, 8.0), seeds=[seed])
    if state.collided[0]:
        return  # a box stands there
    core.advance(world, state, 400)
    assert not state.collided[0]


def test_shifting_the_world_shifts_the_motion() -> None:
    def build(shift: float) -> tuple[core.World, core.State]:
        return scene(
            *(
                agent(pose=[k + shift, math.sin(k) + shift, 0.3 * k], goals=[[5 - k + shift, 3 + shift]])
                for k in range(6)
            ),
            mode=1,
        )

    plain, moved = build(0.0), build(64.0)
    for world, state in (plain, moved):
        core.advance(world, state, 10)
    np.testing.assert_allclose(moved[1].pose[:, :2] - 64.0, plain[1].pose[:, :2], atol=1e-9)
