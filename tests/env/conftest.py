"""Scenario files written from a test's own text."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import irsim


@pytest.fixture
def make(tmp_path: Path) -> Callable[..., Any]:
    """``make(text, **kwargs)``: an environment without drawing from a scenario text."""

    def build(text: str, **kwargs: Any) -> Any:
        path = tmp_path / f"scenario_{len(list(tmp_path.iterdir()))}.yaml"
        path.write_text(text)
        return irsim.make(str(path), headless=True, **{"log_level": "ERROR", **kwargs})

    return build
