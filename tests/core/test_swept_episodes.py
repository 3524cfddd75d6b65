"""Contacts between the steps of whole episodes against shapely: mixed bodies and drives, compounds, rooms and maps."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
import shapely
import yaml
from numpy.typing import NDArray
from PIL import Image

import irsim
from irsim.common.event_kinds import BETWEEN_STEPS
from tests.core.test_swept_oracle import SLACK, Body, clearance, verdict

Floats = NDArray[np.float64]
SIZE = 8.0
"""Width and height of the world [m]."""
CELL = 0.125
"""Side of a cell of a map [m]."""
STEPS = 30
ENDS = np.array([0.0, 1.0])
FIXED = ("obstacle_12", "boundary")
"""Names of the map and of the walls round the world, whose outlines are in the world frame."""
Motion = tuple[tuple[float, float], float]
"""Displacement [m], and turn [rad]."""


class Outline(NamedTuple):
    """One part of a body in its own frame: a point with a radius, a line, or a polygon."""

    core: Any
    radius: float = 0.0

    @property
    def reach(self) -> float:
        """Largest distance from the origin [m]."""
        return float(np.hypot(*shapely.get_coordinates(self.core).T).max()) + self.radius


def any_shape(rng: np.random.Generator) -> dict[str, Any]:
    kind = str(rng.choice(["circle", "rectangle", "polygon", "compound"]))
    if kind == "circle":
        return {"name": kind, "radius": float(rng.uniform(0.03, 0.3))}
    if kind == "rectangle":
        length, width = rng.uniform(0.05, 0.6, 2).tolist()
        return {"name": kind, "length": length, "width": width}
    if kind == "polygon":
        count = int(rng.integers(3, 7))
        angle = np.sort((np.arange(count) + rng.uniform(0.1, 0.9, count)) * 2 * np.pi / count)
        corners = rng.uniform(0.05, 0.3, count)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        return {"name": kind, "vertices": corners.tolist()}
    part = {"name": "rectangle", "length": 0.1, "width": 0.4, "pose": [float(rng.uniform(0.2, 0.4)), 0, 0]}
    return {"name": kind, "parts": [{"name": "rectangle", "length": 0.6, "width": 0.1}, part]}


def pose(rng: np.random.Generator) -> list[float]:
    return [*rng.uniform(1.0, SIZE - 1.0, 2).tolist(), float(rng.uniform(-3, 3))]


def movers(rng: np.random.Generator) -> Iterator[dict[str, Any]]:
    """Robots that drive straight to one random goal after the other, so fast that they jump."""
    for k in range(8):
        shape, drive, speed = any_shape(rng), ["diff", "omni", "omni_angular", "diff"][k % 4], float(rng.uniform(1, 4))
        limits = {"diff": [speed, 2.0], "omni": [speed, speed], "omni_angular": [speed, speed, 2.0]}[drive]
        yield {
            "name": f"mover_{k}", "kinematics": {"name": drive}, "shape": shape,
            "behavior": {"name": "dash", "wander": True, "range_low": [-1, -1], "range_high": [SIZE + 1, SIZE + 1]},
            "state": pose(rng), "goal_threshold": 0.8,
            "vel_max": limits, "vel_min": [-limit for limit in limits],
        }  # fmt: skip


def walls(rng: np.random.Generator) -> Iterator[dict[str, Any]]:
    """Lines, a room with an opening, and other bodies that stand."""
    room = [[-0.6, -0.6], [0.6, -0.6], [0.6, 0.6], [-0.6, 0.6], [-0.6, -0.2]]
    thin = [[-0.5, 0.0], [0.5, 0.0], [0.6, 0.3]]
    for k, points in enumerate((room, thin, None, None)):
        shape = {"name": "linestring", "vertices": points} if points else any_shape(rng)
        yield {"name": f"wall_{k}", "shape": shape, "state": pose(rng)}


def draw_map(rng: np.random.Generator, file: Path) -> None:
    """Draw some walls of single cells."""
    count = round(SIZE / CELL)
    picture = np.full((count, count), 255, np.uint8)
    for _ in range(4):
        row, column = rng.integers(10, count - 10, 2)
        if rng.uniform() < 0.5:
            picture[row, column - 9 : column + 10] = 0
        else:
            picture[row - 9 : row + 10, column] = 0
    Image.fromarray(picture).save(file)


def episode(seed: int, folder: Path) -> irsim.Env:
    """A random scene; every third has a map, every other one walls round the world."""
    rng = np.random.default_rng(seed)
    robots, things = list(movers(rng)), list(walls(rng))
    world = {
        "width": SIZE, "height": SIZE, "step_time": float(rng.choice([0.1, 0.2, 0.4, 0.6])), "seed": seed,
        "integration": str(rng.choice(["euler", "exact"])),
        "collision_mode": str(rng.choice(["stop", "unobstructed"], p=[0.1, 0.9])),
    }  # fmt: skip
    if seed % 3 == 0:
        draw_map(rng, folder / f"{seed}.png")
        world["obstacle_map"] = f"{seed}.png"
    if seed % 2 == 0:
        world["boundary"] = "walls"
    file = folder / f"{seed}.yaml"
    file.write_text(yaml.safe_dump({"world": world, "robot": robots, "obstacle": things}), encoding="utf-8")
    return irsim.make(file, display=False, log_level="ERROR")


def outlines(env: irsim.Env, row: int) -> list[Outline]:
    """The parts of a body in its own frame, or in the world frame for the map and the walls round it."""
    state, parts = env.simulation.state, []
    for part, kind in enumerate(state.parts(row)):
        corners = state.vertices(row, part, False)
        if kind == "circle":
            *center, radius = state.circle(row, part, False)
            parts.append(Outline(shapely.Point(center), radius))
        elif kind == "cells":
            grid = state.cells(row)
            assert grid is not None
            low = np.argwhere(grid.occupied) * grid.cell + np.array(grid.origin)
            parts += [Outline(shapely.box(*at, *(at + grid.cell))) for at in low]
        elif kind == "polygon":
            parts.append(Outline(shapely.Polygon(corners)))
        else:
            parts.append(Outline(shapely.LineString([*corners, *corners[: kind == "room"]])))
    return parts


def motions(before: Floats, after: Floats, exact: bool) -> Motion:
    """Displacement, of an arc the one without its turn, and turn of a step."""
    turn = float(np.angle(np.exp(1j * (after[2] - before[2]))))
    by = complex(*(after - before)[:2])
    if exact and turn:
        by /= complex(np.sin(turn), 1 - np.cos(turn)) / turn
    return (by.real, by.imag), turn


def placed(part: Outline, start: Floats, moved: Motion, exact: bool) -> Body:
    """A part with its motion in one step."""
    x, y, heading = start.tolist()
    return Body(part.core, part.radius, (x, y, heading), *moved, exact)


def expected(bodies: dict[str, list[Outline]], before: Floats, after: Floats, exact: bool) -> dict[frozenset[str], Any]:
    """Verdict of every pair that may meet within a step; None where less than the slack decides."""
    moved = {name: motions(before[k], after[k], exact) for k, name in enumerate(bodies)}
    starts = dict(zip(bodies, before, strict=True))
    verdicts: dict[frozenset[str], Any] = {}
    for a, b in itertools.combinations(bodies, 2):
        if not any(moved[a][0]) and not moved[a][1] and not any(moved[b][0]) and not moved[b][1]:
            continue
        pairs = []
        way = float(np.hypot(*moved[a][0]) + np.hypot(*moved[b][0]))
        for one, other in itertools.product(bodies[a], bodies[b]):
            if b in FIXED:  # far from its origin: what counts is its distance from the other's
                near = shapely.distance(other.core, shapely.Point(*starts[a][:2])) <= one.reach + way
            else:
                near = np.hypot(*(starts[a] - starts[b])[:2]) <= one.reach + other.reach + way
            if near:
                pairs.append((placed(one, starts[a], moved[a], exact), placed(other, starts[b], moved[b], exact)))
        if not pairs:
            continue
        ends = np.min([clearance(first, second, ENDS) for first, second in pairs], axis=0)
        if (ends <= SLACK).any():
            verdicts[frozenset((a, b))] = None if ends.all() and (ends > -SLACK).all() else False  # 0: outlines overlap
            continue
        told = [verdict(first, second) for first, second in pairs]
        verdicts[frozenset((a, b))] = True if True in told else None if None in told else False
    return verdicts


def compare(seed: int, folder: Path) -> tuple[int, int]:
    """Run an episode; the numbers of contacts between steps, and of steps of pairs that nearly touch."""
    env = episode(seed, folder)
    exact = env.scenario.world.integration == "exact"
    bodies = {view.name: outlines(env, view.row) for view in env.objects}

    def poses() -> Floats:
        return np.array([np.zeros(3) if view.name in FIXED else view.state[:3, 0] for view in env.objects])

    contacts = looked = told = 0
    try:
        before = poses()
        for step in range(1, STEPS + 1):
            env.step()
            after = poses()
            events = env.events[told:]
            told += len(events)
            reported = {frozenset((e.object, e.partner)) for e in events if e.kind in BETWEEN_STEPS}
            wanted = expected(bodies, before, after, exact)
            for pair, verdict_ in wanted.items():
                assert verdict_ is None or verdict_ == (pair in reported), (seed, step, sorted(pair), verdict_)
            assert reported <= set(wanted), (seed, step)
            contacts, looked, before = contacts + len(reported), looked + len(wanted), after
    finally:
        env.end()
    return contacts, looked


def test_some_episodes(tmp_path: Path) -> None:
    counts = np.sum([compare(seed, tmp_path) for seed in (5, 102)], axis=0)  # 102: through a wall of a map
    assert counts[0] > 10
    assert counts[1] > 250


@pytest.mark.rotates(4)
@pytest.mark.slow(35)
@pytest.mark.parametrize("first", range(100, 200, 25))
def test_a_hundred_episodes(first: int, tmp_path: Path) -> None:
    counts = np.sum([compare(seed, tmp_path) for seed in range(first, first + 25)], axis=0)
    assert counts[0] > 100
    assert counts[1] > 3000
