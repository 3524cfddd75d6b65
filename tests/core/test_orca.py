"""`orca`: its programs against plain enumeration, its law in small worlds, and that it keeps its promises."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume
from hypothesis import strategies as st

import irsim
import irsim._core as core
from tests.core.worlds import (
    DRIVES,
    assert_success,
    circle,
    collisions,
    decided,
    kernel,
    line,
    obstacle,
    rectangle,
    robot,
    scene,
)
from tests.effort import for_all

ANGLE = st.floats(-math.pi, math.pi)
PLANE = st.tuples(st.floats(-2, 2), st.floats(-2, 2), ANGLE).map(lambda p: (p[0], p[1], math.cos(p[2]), math.sin(p[2])))


def agent(pose: Any, goal: Any, drive: str = "omni", **overrides: Any) -> core.ObjectSpec:
    keys: dict[str, Any] = {
        "drive": DRIVES[drive],
        "pose": [*pose, 0.0][:3],
        "goals": [list(goal)],
        "behavior": kernel("orca"),
        "grouped": True,
    }
    return robot(**{**keys, **overrides})


# the programs


def depths(planes: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(planes,) how far `v` is inside each."""
    offset = v - planes[:, :2]
    return planes[:, 2] * offset[:, 1] - planes[:, 3] * offset[:, 0]


def all_depths(planes: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(velocities, planes) how far each of many velocities is inside each plane."""
    x, y = v[:, None, 0] - planes[:, 0], v[:, None, 1] - planes[:, 1]
    return planes[:, 2] * y - planes[:, 3] * x


def corners(planes: np.ndarray, max_speed: float, preferred: np.ndarray) -> np.ndarray:
    """(K, 2) every velocity that can be the answer: the preferred one, its feet, and where borders meet."""
    points = [preferred, preferred * min(1.0, max_speed / max(np.linalg.norm(preferred), 1e-12))]
    for x, y, dx, dy in planes:
        p, d = np.array([x, y]), np.array([dx, dy])
        points.append(p + d * (d @ (preferred - p)))
        chord = max_speed**2 - (p @ np.array([-dy, dx])) ** 2
        if chord >= 0:
            points += [p + d * (-(p @ d) + sign * math.sqrt(chord)) for sign in (-1, 1)]
    for a, b in itertools.combinations(planes, 2):
        sine = a[2] * b[3] - a[3] * b[2]
        if abs(sine) > 1e-12:
            gap = a[:2] - b[:2]
            points.append(a[:2] + a[2:] * ((b[2] * gap[1] - b[3] * gap[0]) / sine))
    return np.array(points)


def allowed(planes: np.ndarray, max_speed: float, preferred: np.ndarray, slack: float = 1e-9) -> np.ndarray:
    """(K, 2) those within every plane."""
    v = corners(planes, max_speed, preferred)
    inside = np.array([np.linalg.norm(w) <= max_speed + slack and (depths(planes, w) >= -slack).all() for w in v])
    return v[inside]


@for_all(300, st.lists(PLANE, min_size=1, max_size=7), st.floats(0.1, 2), st.tuples(st.floats(-2, 2), st.floats(-2, 2)))
def test_best_velocity_is_the_best_corner(planes: Any, max_speed: float, preferred: tuple[float, float]) -> None:
    lines, wanted = np.array(planes), np.array(preferred)
    tight = allowed(lines, max_speed, wanted, -1e-6)
    loose = allowed(lines, max_speed, wanted, 1e-6)
    assume(len(loose) == 0 or len(allowed(lines, max_speed, wanted)) > 0)
    x, y, free = core.best_velocity(planes, 0, max_speed, preferred)
    v = np.array([x, y])
    assert np.linalg.norm(v) <= max_speed + 1e-9
    if free:
        assert (depths(lines, v) >= -1e-7).all()
        best = min(np.linalg.norm(w - wanted) for w in loose)
        assert np.linalg.norm(v - wanted) <= best + 1e-4
    else:
        assert len(tight) == 0


@for_all(200, st.lists(PLANE, min_size=2, max_size=6), st.lists(ANGLE, max_size=2), st.floats(0.3, 2))
def test_where_nothing_is_free_the_largest_violation_is_least(planes: Any, walls: Any, max_speed: float) -> None:
    hard = [(0.0, 0.0, math.cos(a), math.sin(a)) for a in walls]
    x, y, free = core.best_velocity(hard + planes, len(hard), max_speed, (1.0, 0.0))
    assume(not free)
    v, soft = np.array([x, y]), np.array(planes)
    assert np.linalg.norm(v) <= max_speed + 1e-7  # half-planes that nearly face each other lose digits
    assert all((depths(np.array([h]), v) >= -1e-7).all() for h in hard)
    violation = -depths(soft, v).min()
    # nothing in a fine fan of velocities is better
    angle, speed = np.meshgrid(np.linspace(-math.pi, math.pi, 73), np.linspace(0, max_speed, 21))
    fan = np.stack([speed * np.cos(angle), speed * np.sin(angle)], axis=-1).reshape(-1, 2)
    for plane in hard:
        fan = fan[all_depths(np.array([plane]), fan)[:, 0] >= 0]
    assert (violation <= -all_depths(soft, fan).min(axis=1) + 1e-6).all()


def test_the_nearest_of_many() -> None:
    rng = np.random.default_rng(3)
    for count, shape in ((40, 1.0), (300, 1.0), (300, 0.0), (900, 0.02)):
        points = rng.uniform(-20, 20, (count, 2)) * (1.0, shape)
        points[::17] = points[1]  # of one point the lower index comes first
        for centre in points[:20]:
            for reach, most in ((3.0, 5), (100.0, 12), (8.0, 1000)):
                distance2 = ((points - centre) ** 2).sum(axis=1)
                order = [int(i) for i in np.lexsort((np.arange(count), distance2)) if distance2[i] < reach**2]
                assert core.nearest_points(points.tolist(), tuple(centre), (1, 0), reach, most) == order[:most]


@pytest.mark.parametrize("count", [4, 80])
def test_of_equally_near_points_those_on_the_right_come_first_wherever_they_are_listed(count: int) -> None:
    cross = [(3.0, 0.0), (0.0, 3.0), (-3.0, 0.0), (0.0, -3.0)]
    far = [(50.0 + k, 0.0) for k in range(count - 4)]
    for order in itertools.permutations(cross):
        for ahead, first in (((1, 0), (0, -3)), ((0, 2), (3, 0)), ((-1, 0), (0, 3))):
            points = [*far, *order]
            for most in (1, 4):
                indices = core.nearest_points(points, (0, 0), ahead, 40, most)
                assert points[indices[0]] == first
                assert len(indices) == most


# the law


SLOWING = {"behavior": kernel("orca", approach_time=2.0)}


@pytest.mark.parametrize(
    ("drive", "away", "speed", "options"),
    [
        *((drive, 4.0, 0.6 if drive.startswith("omni") else 1.0, {}) for drive in DRIVES),
        *((drive, 0.05, 0.0, {"goal_threshold": 0.2}) for drive in DRIVES),  # within the threshold it rests
        *(("omni", away, speed, SLOWING) for away, speed in ((3.0, 0.6), (1.0, 0.5), (0.3, 0.15))),
    ],
)
def test_alone_it_goes_straight_to_the_goal_at_its_own_speed(
    drive: str, away: float, speed: float, options: dict[str, Any]
) -> None:
    state = decided(agent((1, 1, 0.0), (1 + away, 1), drive, vel_max=[1.0, 0.6, 2.0], **options))
    np.testing.assert_allclose(state.command[0], [speed, 0.0, 0.0], atol=1e-12)


def test_two_share_the_change_and_others_leave_it_to_it() -> None:
    def sideways(*others: core.ObjectSpec) -> float:
        state = decided(agent((0, 0), (10, 0), control=[1.0, 0.0, 0.0]), *others)
        return float(state.command[0, 1])

    oncoming = {"pose": (4, 0.1, math.pi), "goal": (-10, 0.1)}
    drive: dict[str, Any] = {"control": [1.0, 0.0, 0.0]}
    omni = {**drive, "drive": DRIVES["omni"], "behavior": None}
    shared = sideways(agent(**oncoming, **drive))
    alone = sideways(robot(pose=[4, 0.1, math.pi], group=1, **omni))
    other_group = sideways(agent(**oncoming, **drive, group=1))
    assert shared < -1e-3
    assert alone == pytest.approx(2 * shared, rel=0.35)
    assert other_group == shared, "who avoids by orca gives way too, in whatever group"
    assert sideways(robot(role=1, pose=[4, 0.1, math.pi], group=1, **omni)) == alone
    state = decided(
        agent((0, 0), (10, 0), control=[1.0, 0.0, 0.0], target_roles=1),
        robot(role=1, pose=[4, 0.1, math.pi], group=1, **omni),
    )
    assert state.command[0, 1] == 0.0, "target_roles: robot does not show obstacles"


def test_its_share_of_the_change_can_be_given() -> None:
    def sideways(share: float | None, other: core.ObjectSpec) -> float:
        mine = agent((0, 0), (10, 0), control=[1.0, 0.0, 0.0], behavior=kernel("orca", responsibility=share))
        state = decided(mine, other)
        return float(state.command[0, 1])

    oncoming: dict[str, Any] = {"pose": (4, 0.1, math.pi), "goal": (-10, 0.1), "control": [1.0, 0.0, 0.0]}
    sees, blind = agent(**oncoming), agent(**oncoming, role=1, group=1, target_roles=2)
    assert sideways(None, sees) == sideways(0.5, sees) == sideways(0.5, blind)
    assert sideways(None, blind) == sideways(1.0, blind) == sideways(1.0, sees)
    assert sideways(1.0, sees) < sideways(0.5, sees) < -1e-3


def test_unobstructed_things_that_stand_are_no_obstacle() -> None:
    def forward(**keys: Any) -> float:
        state = decided(agent((0, 0), (10, 0)), obstacle(**{"pose": [1.0, 0.0, 0.0], **keys}))
        return float(state.command[0, 0])

    for parts in ([circle(0.3)], [rectangle(0.4, 1.0)], [line((0, -1), (0, 1))]):
        assert forward(parts=parts) < 0.4
        assert forward(parts=parts, unobstructed=True) == 1.0


def test_a_line_is_a_wall_from_both_sides() -> None:
    for side in (-1.0, 1.0):
        for ends in (((0, -2), (0, 0), (0, 2)), ((0, 2), (0, 0), (0, -2))):
            state = decided(agent((side, 0.3), (-side * 5, 0.3)), obstacle(parts=[line(*ends)]))
            assert abs(state.command[0, 0]) < 0.3


def test_who_cannot_move_sideways_brakes_where_it_faces_a_wall() -> None:
    for drive in ("diff", "steer", "angular"):
        world, state = scene(
            agent((0.0, 0.0, 0.4), (10, 0), drive, control=[1.0, 0.0, 0.0], vel_max=[1.0, 0.7, 0.0]),
            obstacle(parts=[rectangle(20.0, 0.2)], pose=[0.0, 0.7, 0.0]),
            mode=1,
        )
        for _ in range(150):
            core.advance(world, state, 1)
            assert not state.collided[0], drive
        assert state.pose[0, 0] > 5.0, "and goes on along it"


def test_who_faces_a_wall_within_its_margin_turns_away_by_little_and_goes_on() -> None:
    for drive in ("diff", "steer", "angular"):
        near = agent((0.0, 0.0, 0.03), (10, -0.5), drive, parts=[circle(0.3)])
        world, state = scene(near, obstacle(parts=[rectangle(20.0, 0.2)], pose=[0.0, 0.45, 0.0]), mode=1)
        core.advance(world, state, 100)
        assert not state.collided[0], drive
        assert state.pose[0, 0] > 5.0, drive


# what it promises


def crowd(rng: np.random.Generator, count: int, size: float, **keys: Any) -> list[core.ObjectSpec]:
    """Agents that do not touch at the start, with goals across the place."""
    places: list[np.ndarray] = []
    while len(places) < count:
        p = rng.uniform(0, size, 2)
        if all(np.hypot(*(p - q)) > 0.55 for q in places):
            places.append(p)
    return [agent(p, rng.uniform(0, size, 2), **keys) for p in places]


@pytest.mark.parametrize("seed", range(12))
def test_omni_agents_collide_only_after_an_infeasible_step(seed: int) -> None:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(6, 40))
    limits = {"vel_max": [1.0, 1.0, 0.0], "behavior": kernel("orca", maxNeighbors=count, safe_radius=0.0)}
    world, state = scene(*crowd(rng, count, 0.9 * math.sqrt(count), **limits), mode=1)
    for _ in range(200):
        before = state.infeasible.copy()
        touching = {tuple(p) for p in core.State.collision_pairs(state, 0)}
        core.advance(world, state, 1)
        for i, j in state.collision_pairs(0):
            if (i, j) not in touching:
                assert (state.infeasible > before)[[i, j]].any(), (i, j)
    mask = np.ones(1, dtype=np.uint8)
    state.reset(mask, False)
    assert not state.infeasible.any()


WALLS = {
    "corridor": [((6, 1.1), (12, 0.2)), ((6, -1.1), (12, 0.2))],
    "doorway": [((6, 2.6), (0.2, 4.0)), ((6, -2.6), (0.2, 4.0)), ((6, 4.7), (14, 0.2)), ((6, -4.7), (14, 0.2))],
}


@pytest.mark.parametrize("kind", WALLS)
@pytest.mark.parametrize("drive", DRIVES)
def test_walls_are_never_crossed(kind: str, drive: str) -> None:
    rng = np.random.default_rng(8)
    walls = [obstacle(parts=[rectangle(*size)], pose=[*place, 0.0]) for place, size in WALLS[kind]]
    agents = []
    for k in range(8):
        side = 1 if k % 2 else -1
        start = (6 + side * (2 + 0.5 * k), rng.uniform(-0.5, 0.5), 0.0 if side < 0 else math.pi)
        car = {"parts": [circle(0.2, (0.1, 0.0))]} if drive in ("steer", "angular") else {}
        agents.append(agent(start, (6 - side * 5, rng.uniform(-0.5, 0.5)), drive, goal_threshold=0.3, **car))
    world, state = scene(*agents, *walls, mode=1)
    for step in range(500):
        core.advance(world, state, 1)
        for i, j in state.collision_pairs(0):
            assert j < 8, f"step {step}: agent {i} meets wall {j}"


@pytest.mark.parametrize("drive", ["steer", "angular"])
def test_a_car_that_faces_a_wall_backs_off_if_it_can_reverse(drive: str) -> None:
    wall = obstacle(parts=[rectangle(0.2, 2.0)], pose=[1.0, 0.0, 0.0])
    for vel_min, moves in ((-1.0, True), (0.0, False)):
        world, state = scene(
            agent((0.4, 0.0, 0.1), (0.4, 4.0), drive, vel_min=[vel_min, -1.0, 0.0], vel_max=[1.0, 1.0, 0.0]),
            wall,
            mode=1,
        )
        reversed_once = False
        for _ in range(300):
            core.advance(world, state, 1)
            reversed_once |= bool(state.control[0, 0] < 0)
            assert not state.collided[0]
        assert reversed_once == moves


RING = """
world: {{width: 12, height: 12, time_limit: 40}}
robot:
  number: 10
  distribution: {{name: circle, radius: 4, center: [6, 6]}}
  kinematics: {{name: {drive}}}
  shape: {{name: circle, radius: 0.3{more}}}
  goal_threshold: 0.3
  vel_max: [{top}]
  group_behavior: {{name: orca, neighborDist: 10, timeHorizon: 5, timeHorizonObst: 5, maxSpeed: 1}}
"""


@pytest.mark.parametrize(("drive", "top"), [("omni", "1, 1"), ("omni_angular", "1, 1, 2"), ("diff", "1, 2")])
def test_rings_from_which_starts_deviate_swap_without_touching(drive: str, top: str) -> None:
    for seed in range(4):
        assert_success(RING.format(drive=drive, top=top, more=""), seed=seed, perturb={"position": 0.35})


def test_cars_on_a_ring_do_not_touch() -> None:
    text = RING.format(drive="acker", top="1, 0.8", more=", wheelbase: 0.4")
    results = [irsim.run(text=text, seed=seed, perturb={"position": 0.35}) for seed in range(4)]
    assert [collisions(result) for result in results] == [[]] * 4
    assert np.mean([robot.time_to_goal is not None for result in results for robot in result.robots]) > 0.8
