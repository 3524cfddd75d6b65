"""A marker for all tests of this folder."""

from __future__ import annotations

import pytest


def pytest_itemcollected(item: pytest.Item) -> None:
    """Contents of templates are the same on every Python."""
    item.add_marker("one_python")
