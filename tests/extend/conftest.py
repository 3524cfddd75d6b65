"""Scenarios of tests about code of users."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import irsim


@pytest.fixture
def make(tmp_path: Path) -> Callable[..., irsim.Env]:
    """Opens a text as an environment without drawing."""

    def open_text(text: str, **kwargs: Any) -> irsim.Env:
        path = tmp_path / "scenario.yaml"
        path.write_text(text, encoding="utf-8")
        return irsim.make(path, **{"headless": True, "log_level": "ERROR", "seed": 1, **kwargs})

    return open_text
