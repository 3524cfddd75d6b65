"""Crowds in a corridor without ends: what is measured, and the cells of the page of results."""

from __future__ import annotations

import numpy as np
import pytest

from tests.benchmarks.pedestrians.corridor import (
    BEHAVIORS,
    DENSITIES,
    LANE_DENSITIES,
    LENGTH,
    WIDTH,
    lane_line,
    lane_order,
    speed_line,
    walk,
    weidmann,
)
from tests.benchmarks.pedestrians.write import PAGE


def test_the_curve_of_weidmann() -> None:
    assert weidmann(5.4) == 0
    assert weidmann(0.01) == pytest.approx(1.34)
    assert weidmann(2.0) == pytest.approx(0.606, abs=1e-3)


def test_order_of_lanes_worked_by_hand() -> None:
    y = np.array([-1.0, -1.1, -0.9, 1.0, 1.1])
    assert lane_order(y, np.array([1, 1, 1, -1, -1])) == 1
    assert lane_order(y, np.array([1, -1, 1, 1, -1])) == pytest.approx((0 + 1 + 0 + 1 + 1) / 5)
    assert np.isnan(lane_order(np.array([0.0, 5.0]), np.array([1, 1])))


def test_one_alone_walks_at_its_wanted_speed_round_and_round() -> None:
    one = walk(BEHAVIORS["sfm"], 1 / (LENGTH * WIDTH), worlds=1)
    wanted = np.random.default_rng(0).normal(1.34, 0.26)
    assert one.speed == pytest.approx(wanted, abs=1e-3)
    assert one.overlapping == 0


def test_people_of_two_directions_form_lanes() -> None:
    flow = walk(BEHAVIORS["sfm, people: eth"], 0.5, both=True, worlds=1)
    assert flow.lanes > 0.9 > 0.2 > flow.mixed


def test_cells_of_the_page_are_derived_again() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert f"{speed_line(DENSITIES[1])}\n" in text
    assert f"{lane_line(LANE_DENSITIES[0])}\n" in text
