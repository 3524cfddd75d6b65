"""A marker for all tests of this folder."""

from __future__ import annotations

import pytest


def pytest_itemcollected(item: pytest.Item) -> None:
    """Numbers of the core are the same on every Python, but for what its bindings tell of Python and NumPy."""
    if not item.get_closest_marker("every_python"):
        item.add_marker("one_python")
