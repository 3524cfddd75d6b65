"""Environments that draw into a temporary folder, and a look at single pixels of their pictures."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim

Files = Callable[[], list[str]]
Look = Callable[..., tuple[int, ...]]
Picture = Callable[[Any], np.ndarray]


@pytest.fixture
def make(tmp_path: Path) -> Callable[..., Any]:
    """``make(text, **kwargs)``: an environment without window whose files go below ``tmp_path``."""

    def build(text: str, name: str = "scenario", **kwargs: Any) -> Any:
        path = tmp_path / f"{name}.yaml"
        path.write_text(text)
        env = irsim.make(str(path), **{"display": False, "log_level": "ERROR", "seed": 1, **kwargs})
        env.path_param.fig_path = str(tmp_path / "figure")
        env.path_param.ani_path = str(tmp_path / "animation")
        env.path_param.ani_buffer_path = str(tmp_path / "animation_buffer")
        return env

    return build


@pytest.fixture
def color_at() -> Look:
    """``color_at(env, x, y)``: (r, g, b) of the picture at a point of the world [m]."""

    def look(env: Any, x: float, y: float) -> tuple[int, ...]:
        return tuple(colors_at(env, [(x, y)])[0].tolist())

    return look


def colors_at(env: Any, points: Any) -> np.ndarray:
    """(N, 3) colours of one picture at points of the world, (N, 2) [m]."""
    picture = whole_picture(env)
    columns, rows = env._env_plot.ax.transData.transform(points).astype(int).T
    return picture[picture.shape[0] - 1 - rows, columns]


@pytest.fixture
def files(tmp_path: Path) -> Files:
    """``files()``: all files below the folder of a test."""
    return lambda: sorted(str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file())


@pytest.fixture
def picture() -> Picture:
    """``picture(env)``: (H, W, 3) the whole figure."""
    return whole_picture


def whole_picture(env: Any) -> np.ndarray:
    plot = env._env_plot
    options, plot.saved_figure_kwargs = plot.saved_figure_kwargs, {**plot.saved_figure_kwargs, "bbox_inches": None}
    try:
        return np.asarray(plot.frame())
    finally:
        plot.saved_figure_kwargs = options
