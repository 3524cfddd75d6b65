"""Each number of the language at its extremes: refused with a code, or run for three steps without any error."""

from __future__ import annotations

import sys

import pytest

import irsim
from tests.fuzz.attempt import How, try_all
from tests.fuzz.extremes import EXTREMES, bounds_of, documents, places

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits of processes need Linux")
PARTS = 10


def check(part: int, parts: int, how: How = "run") -> None:
    """Try one of so many parts of the documents."""
    names, texts = zip(*documents(part, parts), strict=True)
    tally = try_all(enumerate(texts), how=how)
    assert [(names[wrong.index], wrong.what) for wrong in tally.wrong] == []
    assert min(tally.came_to["ran"], tally.came_to["invalid"]) > len(texts) / 10


def test_the_language_has_hundreds_of_numbers_at_many_extremes() -> None:
    matches = places()
    assert len({path for path, _, _ in matches}) > 300
    assert len(EXTREMES) == 21
    assert all(bounds_of(number) or "acce" in path for path, number, _ in matches)


def test_some_extremes() -> None:
    check(0, 200)


def test_more_controls_than_the_drive_has_are_compared() -> None:
    text = next(text for name, text in documents() if name == "robot.0.vel_dim = 64")
    assert irsim.benchmark(text, seeds=1, steps=3, workers=1).rows


@pytest.mark.slow(20)
@pytest.mark.rotates(PARTS)
@pytest.mark.parametrize("part", range(PARTS))
def test_all_extremes(part: int) -> None:
    check(part, PARTS)


@pytest.mark.slow(20)
@pytest.mark.rotates(2 * PARTS)
@pytest.mark.parametrize("how", ["render", "benchmark"])
@pytest.mark.parametrize("part", range(PARTS))
def test_a_tenth_of_all_extremes_is_drawn_and_compared(part: int, how: How) -> None:
    check(10 * part, 10 * PARTS, how)
