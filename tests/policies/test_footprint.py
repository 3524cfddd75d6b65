"""Footprints as policies learn them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from irsim.common.outline import outline
from tests.policies.scenes import simulation

DISK = {"name": "circle", "radius": 0.3, "center": [0.1, 0.2]}
BAR = {"name": "rectangle", "length": 2, "width": 0.2}


def corners_of(shape: dict[str, Any]) -> Any:
    return outline(simulation({"shape": shape, "state": [4, 3, 1.0]}).state, 0).hull()


def test_no_part_of_a_disk_is_outside_of_its_16_corners() -> None:
    corners = corners_of(DISK)
    assert corners.shape == (16, 2)
    sides = np.roll(corners, -1, axis=0) - corners
    to_middle = np.array([0.1, 0.2]) - corners
    left = (sides[:, 0] * to_middle[:, 1] - sides[:, 1] * to_middle[:, 0]) / np.hypot(*sides.T)
    assert left == pytest.approx(0.3), "the sides touch the disk, which is to their left"


def test_corners_are_in_the_body_frame_and_counterclockwise() -> None:
    corners = corners_of(BAR)
    first = np.lexsort(corners.T[::-1])[0]
    expected = [[-1, -0.1], [1, -0.1], [1, 0.1], [-1, 0.1]]
    np.testing.assert_allclose(np.roll(corners, -first, axis=0), expected)


def test_a_compound_has_the_hull_of_its_parts() -> None:
    corners = corners_of({"name": "compound", "parts": [BAR, {**BAR, "length": 0.2, "width": 2}]})
    assert len(corners) == 8
    assert (corners.max(axis=0), corners.min(axis=0)) == (pytest.approx([1, 1]), pytest.approx([-1, -1]))
