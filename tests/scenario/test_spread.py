"""How values are spread over the objects of an entry."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from irsim.scenario.read import read
from irsim.scenario.resolve.per_object import is_per_object, kind_of, spread

numbers = st.floats(allow_nan=False) | st.integers() | st.booleans()
vectors = st.lists(numbers, max_size=4)
scalars = numbers | st.none() | st.text(max_size=3) | st.dictionaries(st.text(max_size=3), numbers, max_size=2)
others = st.text(max_size=3) | st.none() | vectors | st.dictionaries(st.text(max_size=3), numbers, max_size=2)


@pytest.mark.parametrize(
    ("value", "count", "expected"),
    [
        (0.3, 3, [0.3, 0.3, 0.3]),
        ("r", 2, ["r", "r"]),
        (None, 2, [None, None]),
        ({"name": "diff"}, 2, [{"name": "diff"}] * 2),
        ([1, 2], 3, [[1, 2]] * 3),
        ([True, False], 2, [[True, False]] * 2),
        ([], 2, [[], []]),
        ([[1, 2], [3, 4]], 2, [[1, 2], [3, 4]]),
        ([[1, 2], [3, 4]], 4, [[1, 2], [3, 4], [3, 4], [3, 4]]),
        ([[1, 2], [3, 4], [5, 6]], 2, [[1, 2], [3, 4]]),
        (["r", "b"], 3, ["r", "b", "b"]),
        ([1, "a"], 2, [1, "a"]),
        ([{"name": "a"}], 2, [{"name": "a"}] * 2),
        ([[[1, 1], [2, 2]]], 2, [[[1, 1], [2, 2]]] * 2),
        ([[[1, 1], [2, 2]], [3, 3]], 2, [[[1, 1], [2, 2]], [3, 3]]),
        ([1, 2], 0, []),
        (["a"], 0, []),
    ],
)
def test_the_rule(value: Any, count: int, expected: list[Any]) -> None:
    assert spread(value, count) == expected


def test_exceptions() -> None:
    sensor, other = {"name": "lidar2d"}, {"name": "contact2d"}
    assert kind_of("vel_max") == kind_of("color") == "value"
    assert spread([sensor, other], 2, kind_of("sensors")) == [[sensor, other]] * 2
    assert spread([[sensor], [other]], 3, kind_of("sensors")) == [[sensor], [other], [other]]
    assert spread([1.0, 2.0], 3, kind_of("mass")) == [1.0, 2.0, 2.0]
    assert spread(["a", "b"], 2, kind_of("tags")) == [["a", "b"]] * 2
    assert spread([[1, 1], [2, 2]], 2, kind_of("waypoints")) == [[[1, 1], [2, 2]]] * 2
    assert spread([[[1, 1], [2, 2]], [[3, 3]]], 2, kind_of("waypoints")) == [[[1, 1], [2, 2]], [[3, 3]]]


@given(scalars | vectors, st.integers(0, 6))
def test_one_value_goes_to_all(value: Any, count: int) -> None:
    assert spread(value, count) == [value] * count


@given(st.lists(others, min_size=1, max_size=6), st.integers(0, 8))
def test_lists_go_by_element_and_the_last_is_repeated(values: list[Any], count: int) -> None:
    result = spread(values, count)
    assert len(result) == count
    if is_per_object(values):
        for i, item in enumerate(result):
            assert item is values[min(i, len(values) - 1)]
    else:
        assert all(item is values for item in result)


@given(st.lists(others, max_size=6), st.integers(1, 5))
def test_what_more_objects_get_does_not_change_the_first(values: list[Any], count: int) -> None:
    assert spread(values, count + 3)[:count] == spread(values, count)


@given(others, st.integers(0, 5))
def test_nothing_is_changed(value: Any, count: int) -> None:
    before = repr(value)
    spread(value, count)
    assert repr(value) == before


@given(
    st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)).map(list), min_size=1, max_size=5),
    st.lists(st.sampled_from("rgbk"), min_size=1, max_size=5),
    st.integers(1, 6),
)
def test_objects_get_what_the_rule_says(states: list[list[int]], colors: list[str], count: int) -> None:
    reading = read({"obstacle": {"number": count, "state": states, "color": colors, "shape": [{"name": "circle"}]}})
    assert reading.scenario is not None
    expected = zip(spread(states, count), spread(colors, count), strict=True)
    rows = [(record.state[:2], record.color) for record in reading.scenario.objects]
    assert rows == [([float(x), float(y)], color) for (x, y), color in expected]
