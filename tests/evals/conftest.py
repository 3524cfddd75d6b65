"""Where the evals are."""

from __future__ import annotations

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
EVALS = ROOT / "evals"
SKILLS = sorted(path.parent.name for path in (ROOT / "skills").glob("*/SKILL.md"))


def pytest_itemcollected(item: pytest.Item) -> None:
    """Grades and texts are the same on every Python."""
    item.add_marker("one_python")
