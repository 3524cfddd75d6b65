"""Contacts within a step against shapely: random pairs, a third of them grazing from both sides, and whole episodes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shapely

import irsim._core as core
from tests.core.swept_oracle import Body, clearance, first_time, grazing, least_clearance, verdict
from tests.core.worlds import DRIVES, PI, command, robot, scene

BETWEEN = ("contact_between_steps", "passed_through")
STEP = 0.1
ENDS = np.array([0.0, 1.0])


def random_body(rng: np.random.Generator, exact: bool) -> Body:
    """A disc, a convex or star-shaped polygon, or a line, which moves by up to 1.5 m and turns by up to 2 rad."""
    kind, radius = rng.choice(["disc", "convex", "star", "line"], p=[0.3, 0.35, 0.2, 0.15]), 0.0
    if kind == "disc":
        outline: Any = shapely.Point(0, 0)
        radius = float(rng.uniform(0.05, 0.4))
    elif kind == "line":
        outline = shapely.LineString(rng.uniform(-0.4, 0.4, (int(rng.integers(2, 5)), 2)))
    else:
        count = int(rng.integers(3, 8))
        angle = np.sort((np.arange(count) + rng.uniform(0.1, 0.9, count)) * 2 * PI / count)
        far = rng.uniform(0.1, 0.5, count) if kind == "star" else np.full(count, rng.uniform(0.1, 0.5))
        outline = shapely.Polygon(np.stack([far * np.cos(angle), far * np.sin(angle)], axis=1))
    turn = float(rng.uniform(-2, 2)) if rng.uniform() < 0.7 else 0.0
    start = (*rng.uniform(-1, 1, 2).tolist(), float(rng.uniform(-PI, PI)))
    return Body(outline, radius, start, tuple(rng.uniform(-1, 1, 2).tolist()), turn, exact)


def spec(body: Body) -> core.ObjectSpec:
    points = shapely.get_coordinates(body.core).tolist()
    part: core.Part
    if body.core.geom_type == "Point":
        part = core.Circle(radius=body.radius, center=[0.0, 0.0])
    elif body.core.geom_type == "Polygon":
        part = core.Polygon(vertices=points[:-1])
    else:
        part = core.Linestring(vertices=points)
    fast = {"vel_min": [-1e3] * 3, "vel_max": [1e3] * 3, "behavior": None, "drive": DRIVES["omni_angular"]}
    return robot(**fast, parts=[part], pose=list(body.start))


def of_core(a: Body, b: Body) -> tuple[bool, float]:
    """Whether a step of the core reports a contact between steps, and when it begins."""
    world, state = scene(spec(a), spec(b), step_time=STEP, mode=1)
    world.integration = int(a.exact)
    controls = []
    for body in (a, b):
        cosine, sine = np.cos(body.start[2]), np.sin(body.start[2])
        x, y = body.by
        controls.append([(cosine * x + sine * y) / STEP, (cosine * y - sine * x) / STEP, body.turn / STEP])
    command(state, *controls)
    core.advance(world, state, 1)
    events = [k for k, event in enumerate(state.events(0)) if event[0] in BETWEEN]
    return bool(events), state.moments(0)[events[0]][0] if events else 2.0


def apart_at_both_ends(a: Body, b: Body) -> bool:
    return bool((clearance(a, b, ENDS) > 1e-5).all())


def judge(a: Body, b: Body) -> tuple[bool | None, bool]:
    """The oracle's verdict, and whether the core's differs."""
    expected = verdict(a, b)
    meets, when = of_core(a, b)
    swapped, _ = of_core(b, a)
    assert meets == swapped or expected is None
    if expected and least_clearance(a, b) < -1e-3:
        assert when == pytest.approx(first_time(a, b), abs=1e-4)
    return expected, expected is not None and meets != expected


def compare(seed: int, pairs: int, exact: bool) -> None:
    rng = np.random.default_rng(seed)
    counts = {True: 0, False: 0}
    near = differences = done = 0
    while done < pairs:
        a, b = random_body(rng, exact), random_body(rng, exact)
        graze = done % 3 == 0
        if graze:
            relative = np.subtract(b.by, a.by)
            aside = np.array([-relative[1], relative[0]]) / max(np.hypot(*relative), 1e-9)
            edge = grazing(a, b, (float(aside[0]), float(aside[1])))
            if edge is None:
                continue
            offset = edge + float(rng.choice([-1, 1]) * 10 ** rng.uniform(-5.2, -3))
            b = replace(b, start=(b.start[0] + offset * aside[0], b.start[1] + offset * aside[1], b.start[2]))
        if not apart_at_both_ends(a, b):
            continue
        expected, differs = judge(a, b)
        done += 1
        if expected is not None:
            counts[expected] += 1
            near += graze
        differences += differs
    assert differences == 0
    assert min(counts.values()) > pairs // 10
    assert near > 0.3 * pairs * 0.9


@pytest.mark.parametrize("exact", [False, True])
def test_verdicts_are_those_of_shapely(exact: bool) -> None:
    compare(3 + exact, 45, exact)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_two_thousand_pairs(seed: int) -> None:
    compare(100 + seed, 250, seed % 2 == 1)
