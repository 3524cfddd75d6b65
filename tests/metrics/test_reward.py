"""The return of CrowdNav, in episodes whose sum can be written down."""

from __future__ import annotations

import math

import numpy as np
import pytest

from irsim.metrics import robot_metrics
from tests.metrics.test_robot_metrics import HUMAN, event, scenario, straight, trace

DT = 0.1


def reward(
    gap: float, steps: int = 80, arrival: int | None = None, contact: int | None = None, top: float = 1.0
) -> float:
    """The return of a straight drive past a standing human whose surface is `gap` to the side at step 40."""
    resolved = scenario(([1, 5], [9, 5]), rest=HUMAN)
    resolved.objects[0].vel_max = [top, 0.0]
    robot, human = (record.name for record in resolved.objects)
    path = np.stack([straight(steps), np.tile([5.0, 5.5 + gap], (steps + 1, 1))], axis=1)
    events = [] if contact is None else [event("collision", contact, robot, human)]
    events += [] if arrival is None else [event("arrival", arrival, robot)]
    return robot_metrics(trace(resolved, path, [[9, 5]]), resolved, events)[0]["crowdnav_reward"]


def discomfort(gap: float, steps: int) -> float:
    """The sum over steps that begin at t and end at surface distance d of (d - 0.2) 0.5 dt 0.9^t."""
    total = 0.0
    for step in range(1, steps + 1):
        away = math.hypot(1 + DT * step - 5, gap + 0.5) - 0.5
        if 0 < away < 0.2:
            total += (away - 0.2) * 0.5 * DT * 0.9 ** (DT * (step - 1))
    return total


def test_an_arrival_is_worth_less_the_later_it_is() -> None:
    assert reward(2.0, arrival=80) == pytest.approx(0.9**7.9)
    assert reward(2.0, steps=40, arrival=40) == pytest.approx(0.9**3.9)
    assert reward(2.0, arrival=1) == 1.0  # the first step is not discounted
    assert reward(2.0, arrival=80, top=2.0) == pytest.approx(0.9 ** (7.9 * 2))


def test_a_timeout_far_from_everybody_is_worth_nothing() -> None:
    assert reward(2.0) == 0.0
    assert reward(0.2) == 0.0  # at exactly 0.2 m no person is disturbed


def test_coming_close_costs_until_the_end() -> None:
    cost = discomfort(0.1, 80)
    assert cost < -0.002
    assert reward(0.1) == pytest.approx(cost)
    assert reward(0.1, arrival=80) == pytest.approx(cost + 0.9**7.9)
    assert reward(0.1, steps=40) == pytest.approx(discomfort(0.1, 40))


def test_the_first_contact_ends_it_and_replaces_what_its_step_would_earn() -> None:
    assert reward(2.0, contact=31, arrival=80) == pytest.approx(-0.25 * 0.9**3.0)
    assert reward(0.1, contact=40) == pytest.approx(discomfort(0.1, 39) - 0.25 * 0.9**3.9)
    assert reward(2.0, contact=40, arrival=40) == pytest.approx(-0.25 * 0.9**3.9)  # a contact counts before an arrival
    assert reward(2.0, contact=0) == -0.25  # it began in contact


def test_it_needs_a_limit_of_the_speed() -> None:
    assert math.isnan(reward(2.0, arrival=80, top=math.inf))


def test_a_contact_after_the_arrival_does_not_count() -> None:
    assert reward(2.0, arrival=40, contact=60) == pytest.approx(0.9**3.9)
