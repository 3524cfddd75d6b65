"""Places in texts of YAML, and data that are the same."""

from __future__ import annotations

from typing import Any

import pytest
import yaml

from irsim.common.yaml.tree import LOADER, node_at, same_data

TEXT = "a: {b: [1, {2: x}]}\n"


@pytest.mark.parametrize(("path", "value"), [(("a", "b", 0), "1"), (("a", "b", 1, "2"), "x")])
def test_a_path_leads_to_a_node(path: tuple[str | int, ...], value: str) -> None:
    assert node_at(yaml.compose(TEXT, Loader=LOADER), path).value == value


@pytest.mark.parametrize("path", [("c",), ("a", 0), ("a", "b", 2), ("a", "b", "0"), ("a", "b", 0, "d")])
def test_a_path_that_leads_nowhere_is_an_error(path: tuple[str | int, ...]) -> None:
    with pytest.raises(LookupError):
        node_at(yaml.compose(TEXT, Loader=LOADER), path)


SAME = [(1, 1.0), (0.1 + 0.2, 0.3), ([1, {"a": None}], (1.0, {"a": None})), (float("inf"), float("inf"))]
DIFFERENT = [(1, True), (0, False), (1, "1"), (10**400, 1.5), (0.0, 1e-7), ({"a": 1}, {"a": 1, "b": 2}), ([1], [1, 2])]


@pytest.mark.parametrize(("a", "b"), SAME)
def test_the_same_data(a: Any, b: Any) -> None:
    assert same_data(a, b)
    assert same_data(b, a)


@pytest.mark.parametrize(("a", "b"), DIFFERENT)
def test_different_data(a: Any, b: Any) -> None:
    assert not same_data(a, b)
    assert not same_data(b, a)


def test_numbers_may_be_near() -> None:
    assert same_data({"a": [0.0, 3]}, {"a": [1e-7, 3.0000001]}, near=1e-6)
    assert not same_data(0.0, 1e-5, near=1e-6)
