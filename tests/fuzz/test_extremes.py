"""Each number of the language at its extremes: refused with a code, or run for three steps without any error."""

from __future__ import annotations

import sys

import pytest

from tests.fuzz.attempt import try_all
from tests.fuzz.extremes import EXTREMES, bounds_of, documents, places

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits of processes need Linux")
PARTS = 10


def check(part: int, parts: int) -> None:
    """Try one of so many parts of the documents."""
    names, texts = zip(*documents(part, parts), strict=True)
    tally = try_all(enumerate(texts))
    assert [(names[wrong.index], wrong.what) for wrong in tally.wrong] == []
    assert min(tally.came_to["ran"], tally.came_to["invalid"]) > len(texts) / 10


def test_the_language_has_hundreds_of_numbers_at_many_extremes() -> None:
    found = places()
    assert len({path for path, _, _ in found}) > 300
    assert len(EXTREMES) == 21
    assert all(bounds_of(number) or "acce" in path for path, number, _ in found)


def test_some_extremes() -> None:
    check(0, 200)


@pytest.mark.slow(20)
@pytest.mark.rotates(PARTS)
@pytest.mark.parametrize("part", range(PARTS))
def test_all_extremes(part: int) -> None:
    check(part, PARTS)
