"""Documents on which fuzzing once failed and a thousand more; `python -m tests.fuzz --documents 20000` tries others."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from tests.fuzz.attempt import try_all
from tests.fuzz.grammar import document

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits of processes need Linux")
CASES = sorted((Path(__file__).parent / "cases").glob("*.yaml"))


@pytest.mark.slow(14)
def test_what_was_found_once() -> None:
    texts = [case.read_bytes().decode("utf-8") for case in CASES]
    tally = try_all(enumerate(texts), workers=1)
    assert [(CASES[wrong.index].name, wrong.what) for wrong in tally.wrong] == []
    assert tally.came_to.total() == len(CASES) > 0


def test_the_same_documents_every_time() -> None:
    texts = [document(1, index) for index in range(40)]
    assert texts == [document(1, index) for index in range(40)]
    assert len(set(texts)) > 30


@pytest.mark.slow(20)
def test_a_thousand_documents() -> None:
    tally = try_all((index, document(1, index)) for index in range(1000))
    assert [(wrong.index, wrong.what) for wrong in tally.wrong] == []
    assert min(tally.came_to["ran"], tally.came_to["invalid"]) > 100
