"""`keep_gap`: robots under `rvo` and `sfm` leave a part of each gap, so that two that do so never touch."""

from __future__ import annotations

import math

import numpy as np
import pytest

import irsim
from irsim.api import read_scenario
from tests.avoidance.judge import at_ends, within_steps

CROWD = """
world: {{width: 6, height: 6, step_time: {dt}, integration: {integration}, collision_mode: unobstructed}}
robot:
  - number: 12
    distribution: {{name: random, range_low: [0.5, 0.5, -3.14], range_high: [5.5, 5.5, 3.14]}}
    kinematics: {{name: {drive}}}
    shape: {{name: circle, radius: 0.2}}
    behavior: {{name: {law}, loop: true}}
"""
PAIR = """
world: {{width: 10, height: 4, step_time: 0.1}}
{role}:
  - kinematics: {{name: omni}}
    shape: {{name: circle, radius: 0.2}}
    state: [[1, 2, 0], [9, 2.1, 0]]
    goal: [[9, 2], [1, 2.1]]
    number: 2
    distribution: {{name: manual}}
    behavior: {{name: sfm, force_factor_social: 0, {more}}}
"""


def gaps(text: str, seed: int, steps: int, count: int) -> tuple[float, float]:
    """The least gap at the ends of steps, and within them [m]."""
    batch = irsim.batch(read_scenario(text=text, strict=False)[0], 1, seeds=[seed])
    path = [batch.pose[0, :count, :2].copy()]
    for _ in range(steps):
        batch.step()
        path.append(batch.pose[0, :count, :2].copy())
    places = np.array(path)
    return float(at_ends(places, [], 0.2).min()), float(within_steps(places, [], 0.2).min())


@pytest.mark.parametrize("integration", ["euler", "exact"])
@pytest.mark.parametrize("dt", [0.05, 0.2, 0.5])
@pytest.mark.parametrize("drive", ["diff", "omni", "omni_angular", "acker"])
@pytest.mark.parametrize("law", ["rvo", "sfm"])
def test_robots_in_a_crowd_never_touch(law: str, drive: str, dt: float, integration: str) -> None:
    text = CROWD.format(law=law, drive=drive, dt=dt, integration=integration)
    for seed in range(3):
        ends, within = gaps(text, seed, round(20 / dt), 12)
        assert ends > 0
        assert within > (0 if integration == "euler" else -1e-3)


def test_people_and_robots_that_say_so_go_on_as_in_2_12() -> None:
    apart = {more: gaps(PAIR.format(role="robot", more=more), 0, 80, 2)[0] for more in ("", "keep_gap: false")}
    people = gaps(PAIR.format(role="obstacle", more=""), 0, 80, 2)[0]
    assert apart[""] > 0 > apart["keep_gap: false"]
    assert people == pytest.approx(apart["keep_gap: false"])
    assert gaps(PAIR.format(role="obstacle", more="keep_gap: true"), 0, 80, 2)[0] == pytest.approx(apart[""])


@pytest.mark.parametrize(("radius", "count"), [(0.3, 2), (0.3, 5), (0.2, 8)])
def test_wheels_turn_until_they_roll_along_what_is_in_the_way(radius: float, count: int) -> None:
    """Two whose headings were within the dead band of turns stood before each other for ever."""
    text = (
        f"world: {{width: 20, height: 20, time_limit: 60}}\nrobot:\n  - number: {count}\n"
        "    distribution: {name: circle, center: [10, 10], radius: 6}\n"
        f"    kinematics: {{name: diff}}\n    shape: {{name: circle, radius: {radius}}}\n    goal_threshold: 0.2\n"
        "    behavior: {name: sfm}\n"
    )
    assert irsim.run(text=text, seed=0).outcome == "success"


def test_those_that_are_held_up_slide_past() -> None:
    batch = irsim.batch(read_scenario(text=PAIR.format(role="robot", more=""), strict=False)[0], 1, seeds=[0])
    for _ in range(150):
        batch.step()
    assert math.hypot(*(batch.pose[0, 0, :2] - [9, 2])) < 0.5
