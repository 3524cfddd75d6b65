"""Where there is no screen, everything works but the window."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from irsim.graphics.figure import window

pytestmark = pytest.mark.one_python

SCENARIO = "robot: {kinematics: {name: diff}, behavior: {name: dash}, shape: {name: circle}}\n"
SCREENLESS: list[dict[str, str]] = [{"DISPLAY": ":4711", "MPLBACKEND": "Agg"}]
if sys.platform.startswith("linux"):
    SCREENLESS.append({})  # elsewhere there is always a screen
SCRIPT = """
import sys
import irsim
assert "matplotlib" not in sys.modules
env = irsim.make("world.yaml", display=%s, save_ani=True, log_level="ERROR")
env.step()
env.render(0.01)
env.step()
env.render(0.01)
env.show()
env.save_figure("last.png")
env.end(ending_time=5)
assert "matplotlib.pyplot" not in sys.modules
assert "tkinter" not in sys.modules
"""


@pytest.mark.parametrize("display", ["True", pytest.param("False", marks=pytest.mark.slow)])
@pytest.mark.parametrize("variables", SCREENLESS)
def test_no_screen_no_window_but_files(tmp_path: Path, display: str, variables: dict[str, str]) -> None:
    (tmp_path / "world.yaml").write_text(SCENARIO)
    (tmp_path / "run.py").write_text(SCRIPT % display)
    kept = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY", "MPLBACKEND")}
    result = subprocess.run(
        [sys.executable, "run.py"], cwd=tmp_path, env={**kept, **variables}, capture_output=True, text=True, timeout=60
    )
    assert (result.returncode, result.stderr) == (0, "")
    assert (tmp_path / "figure" / "last.png").stat().st_size > 5000
    assert (tmp_path / "animation" / "animation_world.gif").stat().st_size > 3000


class FakeWindow:
    """The parts of a window that the picture needs."""

    def __init__(self, size: tuple[float, float], dpi: float) -> None:
        self.figure = Figure(figsize=(size[0] / dpi, size[1] / dpi), dpi=dpi)
        self.canvas = FigureCanvasAgg(self.figure)
        self.open, self.shown = True, list[tuple[float, np.ndarray]]()

    def refresh(self, seconds: float) -> None:
        self.shown.append((seconds, np.asarray(self.canvas.buffer_rgba()).copy()))

    def close(self) -> None:
        self.open = False


def test_a_window_shows_each_frame(make: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[FakeWindow] = []

    def open_window(size: tuple[float, float], dpi: float, **_: Any) -> FakeWindow:
        opened.append(FakeWindow(size, dpi))
        return opened[-1]

    monkeypatch.setattr(window, "open_window", open_window)
    monkeypatch.setattr(window, "has_screen", lambda: True)
    env = make(SCENARIO, display=True)
    for _ in range(3):
        env.step()
        env.render(0.25)
    (shown,) = opened
    assert [seconds for seconds, _ in shown.shown] == [0.25] * 3
    assert (shown.shown[0][1] != shown.shown[2][1]).any()
    shown.open = False
    env.step()
    env.render()
    assert len(shown.shown) == 3
    env.end(ending_time=0)
    assert not shown.open


def test_windows_need_a_screen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "MPLBACKEND"):
        monkeypatch.delenv(name, raising=False)
    assert not window.has_screen()
    monkeypatch.setenv("DISPLAY", ":0")
    assert window.has_screen()
    monkeypatch.setenv("MPLBACKEND", "agg")
    assert not window.has_screen()
    monkeypatch.delenv("MPLBACKEND")
    monkeypatch.setattr(sys, "platform", "darwin")
    monkeypatch.delenv("DISPLAY")
    assert window.has_screen()


def test_without_a_screen_nothing_is_drawn_before_someone_looks(make: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(window, "has_screen", lambda: False)
    env = make(SCENARIO, display=True)
    for _ in range(3):
        env.step()
        env.render()
    assert not env._env_plot.made
    assert np.asarray(env._env_plot.fig.canvas.buffer_rgba()).min() == 0
