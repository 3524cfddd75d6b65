from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from irsim.runs.replay.drawing import Columns, changes, quantised
from tests.runs.replay.reading import unpacked

NUMBERS = st.integers(-(2**31), 2**31 - 1)


@given(st.lists(st.lists(NUMBERS, min_size=3, max_size=3), max_size=4), st.integers(0, 2), st.text(max_size=9))
def test_a_block_is_read_back(rows: list[list[int]], order: int, text: str) -> None:
    table = np.array(rows, dtype=np.int32).reshape(-1, 3)
    columns = Columns()
    columns.add("table", table, order)
    columns.add("flat", table.ravel(), order)
    head, arrays = unpacked(columns.block({"text": text}))
    assert head["text"] == text
    np.testing.assert_array_equal(arrays["table"], table)
    np.testing.assert_array_equal(arrays["flat"], table.ravel())


def test_smooth_series_are_small() -> None:
    t = np.arange(1000) * 0.1
    columns = Columns()
    columns.add("x", quantised(np.stack([5 + 3 * np.sin(t / 9 + k) for k in range(100)]), 2**-12), 2)
    assert len(columns.block({})) < 100_000  # a byte for each number


def test_what_is_not_finite_is_quantised_all_the_same() -> None:
    steps = quantised([np.nan, np.inf, -np.inf, 0.26, 1e300], 0.125)
    assert steps.tolist() == [0, 2**31 - 1, 1 - 2**31, 2, 2**31 - 1]


def test_changes() -> None:
    series = np.array([[1.0, np.nan], [1.0, np.nan], [2.0, np.nan], [2.0, 3.0]])
    rows, objects = changes([series, np.zeros((4, 2))])
    assert list(zip(objects.tolist(), rows.tolist(), strict=True)) == [(0, 0), (0, 2), (1, 0), (1, 3)]


def test_numbers_that_do_not_fit_are_refused() -> None:
    with pytest.raises(OverflowError):
        Columns().add("x", [2**31])
