"""The folder in which tests of bridges run."""

from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture(autouse=True)
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current directory of each test, which is empty: bridges and exports write files."""
    monkeypatch.chdir(tmp_path)
    return tmp_path
