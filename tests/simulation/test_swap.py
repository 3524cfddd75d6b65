"""A small sample of the circle swaps; ``swap.py`` runs as many as one likes."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from tests.simulation.swap import LEAST_DISTANCE, starts, swap
from tests.warm import warm

pytestmark = pytest.mark.one_python  # numbers of crowds are the same on every Python


def test_starts_are_apart_and_depend_on_the_seed() -> None:
    for robots in (10, 100):
        place = starts(robots, 3)
        gaps = np.linalg.norm(place[:, None] - place[None], axis=2) + 1e9 * np.eye(robots)
        assert gaps.min() >= LEAST_DISTANCE
        assert not np.allclose(place, starts(robots, 4))


@pytest.mark.parametrize("drive", ["omni", "omni_angular", "diff"])
def test_orca_swaps_without_touching(drive: str) -> None:
    out = swap(10, "orca", drive, range(4))
    assert out.success.all()
    assert not out.collided.any()


def test_orca_cars_do_not_touch() -> None:
    out = swap(10, "orca", "acker", range(4))
    assert not out.collided.any()
    assert out.arrived.mean() > 8


def test_help() -> None:
    done = subprocess.run(
        warm([sys.executable, "-m", "tests.simulation.swap", "--help"]), capture_output=True, text=True, check=True
    )
    assert "--robots" in done.stdout
