"""Ties with what stands exactly ahead, and crossings of two that are mirror images: no object waits for ever."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import yaml

import irsim
from irsim.api import read_scenario
from tests.core.test_ties import motion
from tests.core.worlds import assert_success

LAWS = ("orca", "avocado", "avocado, noise: 0")
TOP = {"diff": [1.2, 2], "omni": [1.2, 1.2], "omni_angular": [1.2, 1.2, 2], "acker": [1.2, 0.7]}


def robot(law: str, drive: str, degrees: float, arm: float = 6.0, speed: float = 1.2, radius: float = 0.25) -> Any:
    """A robot whose way leads through the point (10, 10) at an angle to the x axis."""
    angle = math.radians(degrees)
    x, y = arm * math.cos(angle), arm * math.sin(angle)
    car = {"name": "rectangle", "length": 0.5, "width": 0.3, "wheelbase": 0.3}
    top = [speed if value == 1.2 else value for value in TOP[drive]]
    return {
        "kinematics": {"name": drive},
        "shape": car if drive == "acker" else {"name": "circle", "radius": radius},
        "state": [10 - x, 10 - y, 0 if drive == "omni" else angle],
        "goal": [10 + x, 10 + y],
        "goal_threshold": 0.3,
        "vel_max": top,
        "vel_min": [-value for value in top],
        "behavior": yaml.safe_load(f"{{name: {law}}}"),
    }


def scene(robots: list[Any], obstacles: list[Any] | None = None, step: float = 0.1) -> str:
    world = {"width": 20, "height": 20, "step_time": step, "contacts": "swept", "time_limit": 60}
    return yaml.safe_dump({"world": world, "robot": robots, "obstacle": obstacles or []})


def pillar(radius: float, spelling: str = "circle", y: float = 10.0) -> Any:
    circle = {"name": "circle", "radius": radius}
    return {"shape": circle if spelling == "circle" else {"name": "compound", "parts": [circle]}, "state": [10, y, 0]}


@pytest.mark.parametrize("radius", [0.3, 0.5, 1, 2])
@pytest.mark.parametrize("drive", ["diff", "omni", "omni_angular"])
@pytest.mark.parametrize("law", [*LAWS, "orca, timeHorizonObst: 1.5", "orca, sidestep: 10", "avocado, sidestep: -10"])
def test_a_pillar_exactly_ahead_is_passed(law: str, drive: str, radius: float) -> None:
    for degrees, spelling in ((0, "circle"), (30, "circle"), (90, "circle"), (0, "compound")):
        result = irsim.run(text=scene([robot(law, drive, degrees)], [pillar(radius, spelling)]), seed=0)
        assert result.outcome == "success", (degrees, spelling, result.reason)
        assert result.sim_time < 20


@pytest.mark.parametrize("radius", [0.3, 0.5, 1])
@pytest.mark.parametrize("law", LAWS)
def test_a_car_passes_a_pillar_exactly_ahead(law: str, radius: float) -> None:
    for degrees in (0, 30):
        result = irsim.run(text=scene([robot(law, "acker", degrees)], [pillar(radius)]), seed=0)
        assert result.outcome == "success", (degrees, result.reason)


STANDING = {
    "an obstacle that could move": {"kinematics": {"name": "omni"}, "shape": {"name": "circle", "radius": 0.5}},
    "a robot that has arrived": {
        "kinematics": {"name": "diff"}, "shape": {"name": "circle", "radius": 0.3}, "goal": [10, 10],
        "behavior": {"name": "orca"},
    },
}  # fmt: skip


@pytest.mark.parametrize("who", STANDING)
@pytest.mark.parametrize("drive", ["diff", "omni"])
@pytest.mark.parametrize("law", LAWS)
def test_one_that_stands_exactly_ahead_is_passed(law: str, drive: str, who: str) -> None:
    other = STANDING[who] | {"state": [10, 10, 0]}
    result = assert_success(scene([robot(law, drive, 0)], [other]), seed=0)
    assert result.sim_time < 15


def side(law: str, y: float = 10.0) -> float:
    """Largest deviation from the straight way, positive on the left."""
    path = motion(scene([robot(law, "omni", 0)], [pillar(0.5, y=y)]), 100)[:, 0, 1] - 10
    return float(path[np.argmax(np.abs(path))])


def test_a_tie_goes_to_the_right_and_a_negative_sidestep_to_the_left() -> None:
    assert side("orca") < -0.5
    assert side("orca, sidestep: -10") > 0.5
    assert side("orca, sidestep: 0") == 0.0


@pytest.mark.parametrize("law", LAWS)
def test_a_pillar_that_is_not_exactly_ahead_is_passed_as_before(law: str) -> None:
    ours, old = (
        motion(scene([robot(one, "diff", 0)], [pillar(0.5, y=10 + 1e-6)]), 100) for one in (law, f"{law}, sidestep: 0")
    )
    assert np.array_equal(ours, old)


@pytest.mark.parametrize("law", LAWS)
def test_a_goal_in_front_of_a_pillar_is_driven_to_straight(law: str) -> None:
    one = robot(law, "diff", 0) | {"goal": [8, 10]}
    ours, old = (
        motion(scene([one | {"behavior": yaml.safe_load(f"{{name: {name}}}")}], [pillar(0.5)]), 100)
        for name in (law, f"{law}, sidestep: 0")
    )
    assert np.array_equal(ours, old)


CROSSINGS = [(step, arm) for step in (0.05, 0.1, 0.2) for arm in (4, 5, 6, 7)] + [(0.02, 7), (0.025, 6)]


@pytest.mark.parametrize("degrees", [90, pytest.param(60, marks=pytest.mark.slow), 120])
@pytest.mark.parametrize("drive", ["omni", "diff"])
@pytest.mark.parametrize("speed", [0.8, 1.2])
def test_two_that_cross_as_mirror_images_pass_at_every_step(drive: str, speed: float, degrees: float) -> None:
    for step, arm in CROSSINGS:
        pair = [robot("rvo", drive, angle, arm, speed) for angle in (0, degrees)]
        result = irsim.run(text=scene(pair, step=step), seed=0)
        assert result.outcome == "success", (step, arm, result.reason)
        assert result.sim_time < 1.25 * 2 * arm / speed + 2, (step, arm)


def test_a_tie_is_forgotten_with_its_episode() -> None:
    pair = [robot("rvo", "omni", angle) for angle in (0, 90)]
    scenario, _ = read_scenario(text=scene(pair, step=0.05), strict=False)
    batch = irsim.batch(scenario, 1, seeds=[0])
    paths = []
    for _ in range(2):
        batch.reset()
        path = []
        for _ in range(120):
            batch.step()
            path.append(batch.pose[0].copy())
        paths.append(path)
    assert np.array_equal(*paths)


@pytest.mark.parametrize(("radius", "gap", "aside"), [(0.5, 0.1, 0), (0.5, 0, 0.3), (1, 0.3, 0), (2, 0.1, 1)])
@pytest.mark.parametrize("drive", ["diff", "acker"])
@pytest.mark.parametrize("law", ["orca", "avocado"])
def test_two_circles_side_by_side_are_a_dead_end_that_is_announced(
    law: str, drive: str, radius: float, gap: float, aside: float
) -> None:
    half = radius + gap / 2
    text = scene([robot(law, drive, 0)], [pillar(radius, y=10 + aside + side * half) for side in (-1, 1)])
    assert [finding.code for finding in irsim.validate(text=text).findings] == ["needs-planning"]
    result = irsim.run(text=text, seed=0)
    assert result.outcome == "timeout"
    assert "name: follow" in (result.reason or "")
    planned = text.replace(f"name: {law}", f"name: follow\n    local: {law}")
    assert irsim.run(text=planned, seed=0).outcome == "success"


@pytest.mark.parametrize("law", ["orca", "avocado"])
def test_two_circles_that_leave_a_way_are_no_dead_end(law: str) -> None:
    for half, aside in ((0.9, 0), (0.55, 0.9)):  # between them, and outside of both
        text = scene([robot(law, "diff", 0)], [pillar(0.5, y=10 + aside + side * half) for side in (-1, 1)])
        assert irsim.validate(text=text).findings == []
        assert irsim.run(text=text, seed=0).outcome == "success"
