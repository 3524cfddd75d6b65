"""The generator that functions outside any environment draw from."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np

__all__ = ["current_rng"]


def current_rng() -> Any:
    """That of the environment used last (``irsim.util.random.rng``), else one of fresh entropy."""
    try:
        return import_module("irsim.util.random").rng
    except ModuleNotFoundError:
        return np.random.default_rng()
