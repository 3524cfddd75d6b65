"""Contacts within a step against shapely on sampled poses: random pairs, a third of them grazing from both sides."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.ops
from numpy.typing import NDArray

import irsim._core as core
from tests.core.worlds import DRIVES, PI, apply, robot, scene

Floats = NDArray[np.float64]
SAMPLES = 257
"""Poses of a step that are looked at first."""
ZOOMS = 5
"""How often the surroundings of the smallest distances are looked at again, 16 times finer."""
SLACK = 1e-6
"""Clearance below which both verdicts are right [m]."""


@dataclass(frozen=True)
class Body:
    """A body and its motion in one step.

    Attributes:
        core: Its outline in the body frame without `radius`: a point, a line, or a polygon.
        radius: Of a disc [m]; 0 for other shapes.
        start: x, y [m], heading [rad].
        by: Displacement of the origin under Euler's law [m].
        turn: Change of the heading [rad].
        exact: Whether `by` is the displacement without the turn, and the body drives the arc.
    """

    core: Any
    radius: float
    start: tuple[float, float, float]
    by: tuple[float, float]
    turn: float
    exact: bool = False

    def poses(self, times: Floats) -> Floats:
        """(T, 3) poses at these times."""
        x, y, heading = self.start
        if self.exact and self.turn:
            # the integral of the velocity, which turns with the body
            angle = self.turn * times
            along, aside = np.sin(angle) / self.turn, (1 - np.cos(angle)) / self.turn
            dx, dy = self.by[0] * along - self.by[1] * aside, self.by[0] * aside + self.by[1] * along
        else:
            dx, dy = self.by[0] * times, self.by[1] * times
        return np.stack([x + dx, y + dy, heading + self.turn * times], axis=1)

    def placed(self, times: Floats, core: Any = None) -> NDArray[np.object_]:
        """(T,) geometries at these times."""
        core = self.core if core is None else core
        points = shapely.get_coordinates(core)
        poses = self.poses(times)
        cosine, sine = np.cos(poses[:, 2])[:, None], np.sin(poses[:, 2])[:, None]
        turned = np.stack(
            [cosine * points[:, 0] - sine * points[:, 1], sine * points[:, 0] + cosine * points[:, 1]], axis=2
        )
        placed = turned + poses[:, None, :2]
        if core.geom_type == "Point":
            return np.asarray(shapely.points(placed[:, 0]))
        return np.asarray((shapely.polygons if core.geom_type == "Polygon" else shapely.linestrings)(placed))

    def smaller(self) -> Any:
        """The outline, smaller by the slack."""
        if self.core.geom_type == "Polygon":
            return shapely.remove_repeated_points(self.core.buffer(-SLACK, join_style="mitre"))
        if self.core.geom_type == "LineString":
            return shapely.ops.substring(self.core, SLACK, self.core.length - SLACK)
        return self.core


def clearance(a: Body, b: Body, times: Floats) -> Floats:
    """(T,) distances at these times [m]; negative only if a disc is involved, 0 if outlines overlap."""
    return np.asarray(shapely.distance(a.placed(times), b.placed(times))) - a.radius - b.radius


def least_clearance(a: Body, b: Body) -> float:
    """The smallest clearance within the step [m], to 1e-7 m."""
    times = np.linspace(0.0, 1.0, SAMPLES)
    distances = clearance(a, b, times)
    least = float(distances.min())
    inner = np.flatnonzero((distances <= np.r_[np.inf, distances[:-1]]) & (distances <= np.r_[distances[1:], np.inf]))
    for k in inner[np.argsort(distances[inner])][:4].tolist():
        at, width = float(times[k]), 1.0 / (SAMPLES - 1)
        for _ in range(ZOOMS):
            near = np.clip(np.linspace(at - width, at + width, 33), 0.0, 1.0)
            values = clearance(a, b, near)
            at, width = float(near[int(values.argmin())]), width / 16
            least = min(least, float(values.min()))
    return least


def verdict(a: Body, b: Body) -> bool | None:
    """Whether two bodies touch within the step; None if less than the slack decides."""
    least = least_clearance(a, b)
    if least > SLACK:
        return False
    if a.radius + b.radius > 0.0:
        return True if least < -SLACK else None
    less = replace(a, core=a.smaller()), replace(b, core=b.smaller())
    return True if least_clearance(*less) <= 0.0 else None


def first_time(a: Body, b: Body) -> float:
    """The first sampled time at which two bodies that touch overlap, bisected; only for overlaps of some duration."""
    times = np.linspace(0.0, 1.0, 4 * SAMPLES)
    k = int(np.argmax(clearance(a, b, times) <= 0.0))
    low, high = times[k - 1], times[k]
    for _ in range(40):
        middle = 0.5 * (low + high)
        if clearance(a, b, np.array([middle]))[0] <= 0.0:
            high = middle
        else:
            low = middle
    return float(high)


def grazing(a: Body, b: Body, aside: tuple[float, float]) -> float | None:
    """How far `b` must be shifted along a direction so that it is just passed [m]; None if that takes more than 3 m."""

    def shifted(by: float) -> Body:
        return replace(b, start=(b.start[0] + by * aside[0], b.start[1] + by * aside[1], b.start[2]))

    low, high = 0.0, 3.0
    if least_clearance(a, b) > 0.0 or least_clearance(a, shifted(high)) <= 0.0:
        return None
    while high - low > 2e-7:
        middle = 0.5 * (low + high)
        if least_clearance(a, shifted(middle)) > 0.0:
            high = middle
        else:
            low = middle
    return high


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
    apply(world, state, *controls)
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
    compare(3 + exact, 30, exact)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_two_thousand_pairs(seed: int) -> None:
    compare(100 + seed, 250, seed % 2 == 1)
