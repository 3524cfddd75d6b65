"""A sentence is understood at the first reading: constructions that must be read twice are few."""

from __future__ import annotations

from collections import Counter

import pytest

from tests.packaging.english import findings

MOST = 13
"""All that there were when they were first counted. Lower the number after rewriting some."""


@pytest.mark.slow
def test_constructions_that_must_be_read_twice_are_few() -> None:
    rows = list(findings())
    assert len(rows) <= MOST, Counter(name for name, _, _ in rows).most_common()
