"""Contact mode with fast bodies: nothing passes through anything, and everything else is as in a slow step."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

import irsim._core as core
from tests.core.worlds import DRIVES, advanced, apply, circle, line, obstacle, rectangle, robot, scene

CONTACT = 3
WALL_X = 2.0


def grid_wall() -> core.GridCells:
    """One column of occupied cells of 5 cm from y = -2 to y = 2."""
    return core.GridCells(grid=core.OccupancyGrid(np.ones((1, 80), bool), (WALL_X, -2.0), (0.05, 0.05)))


WALLS = {
    "thin": obstacle(pose=[WALL_X + 0.01, 0.0, 0.0], parts=[rectangle(0.02, 4.0)]),
    "line": obstacle(parts=[line((WALL_X, -2.0), (WALL_X, 2.0))]),
    "map": obstacle(parts=[grid_wall()]),
}


def pushed(**options):
    return obstacle(**{"static": False, "mass": 0.5, "friction": 0.2, **options})


def fast_robot(speed: float, **options):
    limits = {"vel_max": [speed, 30.0, 30.0], "vel_min": [-speed, -30.0, -30.0], "behavior": None}
    return robot(
        **{"mass": 10.0, "friction": 5.0, "control": [speed, 0.0, 0.0], "parts": [circle(0.1)], **limits, **options}
    )


def told(state) -> list[str]:
    return [kind for kind, *_ in state.events(0) if kind != "collision"]


@pytest.mark.parametrize("wall", WALLS)
@pytest.mark.parametrize("dt", [0.1, 0.5, 1.0])
@pytest.mark.parametrize("start", [0.0, 0.07, 0.16, 0.23])
def test_no_robot_passes_a_wall(wall: str, dt: float, start: float) -> None:
    world, state = scene(fast_robot(3.0, pose=[start, 0.0, 0.0]), WALLS[wall], mode=CONTACT, step_time=dt)
    apply(world, state, [3.0], steps=round(3.0 / dt))
    assert state.pose[0].tolist() == pytest.approx([WALL_X - 0.1, 0.0, 0.0], abs=2e-3)
    assert told(state) == []


@pytest.mark.parametrize("wall", WALLS)
@pytest.mark.parametrize("size", [0.02, 0.05, 0.2])
@pytest.mark.parametrize(("speed", "dt"), [(0.3, 0.5), (1.0, 0.1), (1.0, 0.5), (3.0, 0.1), (3.0, 0.5)])
def test_no_robot_pushes_a_small_body_through_a_wall(wall: str, size: float, speed: float, dt: float) -> None:
    for start in (0.0, 0.05, 0.1, 0.15, 0.275):
        small = pushed(pose=[start + 0.6, 0.0, 0.0], parts=[rectangle(size, size)])
        driver = fast_robot(speed, pose=[start, 0.0, 0.0])
        world, state = scene(driver, small, WALLS[wall], mode=CONTACT, step_time=dt)
        apply(world, state, [speed], steps=round(2.5 / (speed * dt)) + 3)
        assert state.pose[1, 0] < WALL_X, start
        assert "passed_through" not in told(state), start


@pytest.mark.parametrize("body", ["circle", "square"])
def test_a_body_that_is_shot_at_a_wall_stops_there(body: str) -> None:
    parts = [circle(0.01)] if body == "circle" else [rectangle(0.02, 0.02)]
    for wall in WALLS.values():
        small = pushed(pose=[0.33, 0.025, 0.0], parts=parts, friction=0.0, control=[40.0, 0.0, 0.0])
        state = advanced(3, small, wall, mode=CONTACT)
        assert state.pose[0, 0] == pytest.approx(WALL_X - 0.01, abs=2e-3)
        assert state.control[0, 0] == pytest.approx(0.0, abs=1e-6)
        assert told(state) == []


@pytest.mark.parametrize("turn", [0.6, 1.2, 2.4])
@pytest.mark.parametrize("pole", ["fixed", "loose"])
def test_a_spinning_bar_passes_no_pole(turn: float, pole: str) -> None:
    """The pole stands at an angle of 0.3 rad; one that can be pushed is flung off."""
    place = [0.8 * math.cos(0.3), 0.8 * math.sin(0.3), 0.0]
    post = obstacle if pole == "fixed" else pushed
    bar = fast_robot(1.0, drive=DRIVES["omni_angular"], parts=[rectangle(2.0, 0.02)], control=[0.0, 0.0, 0.0])
    world, state = scene(bar, post(pose=place, parts=[circle(0.02)]), mode=CONTACT)
    apply(world, state, [0.0, 0.0, turn / 0.1])
    x, y = state.pose[1, :2] - state.pose[0, :2]
    angle = state.pose[0, 2]
    left, along = -x * math.sin(angle) + y * math.cos(angle), x * math.cos(angle) + y * math.sin(angle)
    assert left > 0.0 or along > 1.0  # on its side, or flung off beyond the end of the bar
    assert told(state) == []


@pytest.mark.parametrize("count", [1, 3])
def test_a_fast_robot_gives_a_row_of_boxes_its_speed(count: int) -> None:
    """They do not get faster than what pushes them, in however many parts its step is divided."""
    boxes = [
        pushed(pose=[0.5 + 0.11 * k, 0.0, 0.0], parts=[rectangle(0.1, 0.1)], mass=0.1, friction=0.0)
        for k in range(count)
    ]
    world, state = scene(fast_robot(6.0, pose=[0.0, 0.0, 0.0]), *boxes, mode=CONTACT)
    apply(world, state, [6.0], steps=2)
    assert state.control[1 : count + 1, 0] == pytest.approx([6.0] * count, rel=0.02)
    gaps = np.diff(state.pose[: count + 1, 0]) - [0.15] + [0.0] + [0.05 * (k > 0) for k in range(count)]
    assert (gaps > -1e-3).all()


def test_an_overlap_parts_as_fast_while_something_else_is_fast() -> None:
    """A step that is divided for the sake of one body treats an overlap elsewhere as any other step does."""

    def velocities(shot: float) -> np.ndarray:
        pair = [pushed(pose=[x, 9.0, 0.0], parts=[circle(0.2)], friction=0.0) for x in (0.0, 0.3)]
        bullet = pushed(pose=[1.9, 0.0, 0.0], parts=[circle(0.01)], friction=0.0, control=[shot, 0.0, 0.0])
        state = advanced(1, *pair, bullet, WALLS["thin"], mode=CONTACT)
        return state.control[:2].copy()

    slow, fast = velocities(0.0), velocities(40.0)
    assert slow[:, 0] == pytest.approx([-0.5, 0.5], abs=1e-4)
    assert fast == pytest.approx(slow, abs=1e-4)


def test_fast_steps_do_not_depend_on_the_order_of_objects() -> None:
    def poses(turned: bool) -> np.ndarray:
        objects = [
            fast_robot(3.0, pose=[0.0, 0.0, 0.0]),
            pushed(pose=[0.5, 0.02, 0.3], parts=[rectangle(0.06, 0.05)]),
            pushed(pose=[0.8, -0.02, 0.1], parts=[circle(0.03)]),
            WALLS["line"],
        ]
        order = [0, 2, 1, 3] if turned else [0, 1, 2, 3]
        world, state = scene(*[objects[i] for i in order], mode=CONTACT)
        apply(world, state, [3.0], steps=12)
        return state.pose[order].copy()

    assert poses(True) == pytest.approx(poses(False), abs=1e-9)


@pytest.mark.parametrize("turn", [3.0, -3.0])
def test_a_turn_within_a_step_leads_through_no_wall(turn: float) -> None:
    """The arc of the step goes 0.4 m into a thick wall and comes out of it again."""
    thick = obstacle(pose=[WALL_X + 5.0, 0.0, 0.0], parts=[rectangle(10.0, 40.0)])
    driver = fast_robot(30.0, pose=[WALL_X - 0.6, 0.0, 0.0], control=[10.0 * abs(turn), 10.0 * turn, 0.0])
    world, state = scene(driver, thick, mode=CONTACT)
    world.integration = 1
    apply(world, state, [10.0 * abs(turn), 10.0 * turn])
    assert told(state) == []
    assert [(c[0], c[1]) for c in state.contacts(0)] == [(0, 1)]
    assert state.pose[0, 0] <= WALL_X - 0.1 + 1e-3


def test_a_robot_that_slides_along_a_wall_stops_at_the_next_one() -> None:
    """Its way in the step leads past the next wall, but not where the first one lets it go."""
    first = obstacle(pose=[2.0, 5.0, 0.0], parts=[rectangle(20.0, 10.0)])
    second = obstacle(pose=[WALL_X + 0.01, -2.0, 0.0], parts=[rectangle(0.02, 4.0)])
    for angle in (0.2, 0.5, 1.0):
        driver = fast_robot(30.0, pose=[1.0, -0.1, angle], control=[30.0, 0.0, 0.0])
        world, state = scene(driver, first, second, mode=CONTACT)
        apply(world, state, [30.0, 0.0], steps=2)
        assert state.pose[0, 0] <= WALL_X - 0.1 + 1e-3, angle
        assert state.pose[0, 1] <= -0.1 + 1e-3, angle
        assert told(state) == [], angle


ROOM = [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (0.0, 3.0), (0.0, 0.0)]


def walls_of_a_room(kind: str) -> list[core.ObjectSpec]:
    """The walls round a room of 3 m, written in one of several ways."""
    if kind == "line":
        return [obstacle(parts=[line(*ROOM)])]
    if kind == "boundary":
        return [obstacle(parts=[core.Room(vertices=ROOM)])]
    if kind == "lines":
        return [obstacle(parts=[line(p, q)]) for p, q in pairwise(ROOM)]
    cells = np.ones((62, 62), bool)
    cells[1:-1, 1:-1] = False
    return [obstacle(parts=[core.GridCells(grid=core.OccupancyGrid(cells, (-0.05, -0.05), (0.05, 0.05)))])]


def leave_a_room(kind: str, seed: int, steps: int = 5) -> list[tuple[int, int]]:
    """Where a random scene of robots and bodies that they push leaves its room: (step, row)."""
    draw = np.random.default_rng(seed)
    dt, speed = draw.choice([0.05, 0.1, 0.2, 0.5, 1.0]), 10 ** draw.uniform(-0.3, 2.0)
    places = [(0.7, 0.7), (2.3, 0.7), (0.7, 2.3), (2.3, 2.3)]
    parts = [[circle(0.2)], [rectangle(0.5, 0.02)], [rectangle(0.3, 0.2), circle(0.1, (0.2, 0.1))], [circle(0.08)]]
    robots, count = int(draw.integers(1, 4)), int(draw.integers(1, 5))
    drives, objects = ["diff", "omni", "omni_angular", "angular"], []
    for row in range(max(robots, count)):
        pose = [*places[row], draw.uniform(-3.1, 3.1)]
        body = {"pose": pose, "parts": parts[draw.integers(4)], "mass": draw.choice([0.3, 3.0, 30.0])}
        if row < robots:
            drive = DRIVES[drives[draw.integers(4)]]
            objects.append(fast_robot(speed, drive=drive, friction=draw.choice([0.5, 1000.0]), **body))
        else:
            objects.append(pushed(friction=draw.choice([0.0, 0.3]), restitution=draw.choice([0.0, 0.5]), **body))
    world, state = scene(*objects, *walls_of_a_room(kind), mode=CONTACT, step_time=dt)
    world.integration = int(draw.integers(2))
    for step in range(steps):
        controls = [
            [speed * draw.choice([1, 1, -1]), draw.uniform(-20, 20), draw.uniform(-20, 20)] for _ in range(robots)
        ]
        apply(world, state, *controls)
        place = state.pose[: len(objects), :2]
        outside = np.flatnonzero(~((place > -1e-3) & (place < 3.001)).all(axis=1))
        if len(outside):
            return [(step, int(row)) for row in outside]
    return []


@pytest.mark.parametrize("kind", ["line", "lines", "boundary", "map"])
def test_nothing_leaves_a_room(kind: str) -> None:
    assert {seed: gone for seed in range(40) if (gone := leave_a_room(kind, seed))} == {}


@pytest.mark.slow(60)
@pytest.mark.parametrize("kind", ["line", "lines", "boundary", "map"])
def test_nothing_ever_leaves_a_room(kind: str) -> None:
    assert {seed: gone for seed in range(1000, 2500) if (gone := leave_a_room(kind, seed))} == {}


@pytest.mark.parametrize("kind", ["line", "map"])
def test_held_bodies_move_the_same_in_any_batch_on_threads(kind: str) -> None:
    places = [(0.7, 0.7), (2.3, 0.7), (0.7, 2.3), (2.3, 2.3), (1.5, 1.5)]
    parts = [[circle(0.2)], [rectangle(0.5, 0.02)], [circle(0.08)], [circle(0.2)], [rectangle(0.3, 0.2)]]
    bodies = [pushed(pose=[*places[k], 0.3 * k], parts=parts[k]) for k in range(3, 5)]
    robots = [fast_robot(40.0, pose=[*places[k], 2.0 * k], parts=parts[k]) for k in range(3)]
    draw = np.random.default_rng(4)
    controls = draw.uniform(-40, 40, (6, 12, 3, 2))

    def moved(worlds: list[int], threads: int) -> np.ndarray:
        world, state = scene(*robots, *bodies, *walls_of_a_room(kind), seeds=worlds, mode=CONTACT, step_time=0.2)
        for step in controls:
            for place, number in enumerate(worlds):
                rows = slice(place * world.objects, place * world.objects + len(robots))
                state.command[rows, :2] = step[number]
                state.given[rows] = 1
            core.advance(world, state, 1, threads=threads)
        return state.pose.reshape(len(worlds), world.objects, 3)[:, :5].copy()

    together = moved(list(range(12)), 1)
    np.testing.assert_array_equal(moved(list(range(12)), 4), together)
    np.testing.assert_array_equal(np.concatenate([moved([number], 1) for number in range(12)]), together)
