"""The figure shows the present however it is looked at, in windows and without a screen, and pyplot knows it."""

import gc
import io
import itertools
import os
import subprocess
import sys

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from irsim.graphics.figure import window

pytestmark = pytest.mark.one_python

ONE = """
world: {height: 10, width: 10}
robot: {kinematics: {name: diff}, state: [1, 1, 0.78], goal: [9, 9, 0], shape: {name: circle, radius: 0.5},
  behavior: {name: dash}, plot: {show_trajectory: true}}
"""


@pytest.fixture(autouse=True)
def no_figures():
    plt.close("all")
    plt.get_backend()  # chosen now: before Matplotlib 3.10 choosing one later would close the figures that are there
    yield
    plt.close("all")


@pytest.fixture
def env(make):
    return make(ONE)


def drive(env, frames=1):
    for _ in range(frames):
        env.step()
        env.render(0)


def read(figure):
    return np.asarray(figure.canvas.buffer_rgba()).copy()


def drawn(figure):
    figure.canvas.draw()
    return read(figure)


def saved(figure):
    data = io.BytesIO()
    figure.savefig(data, format="png")
    return np.asarray(Image.open(data))


@pytest.mark.parametrize("projection", [None, "3d"])
@pytest.mark.parametrize("look", [drawn, read, saved])
def test_a_kept_figure_shows_every_frame(make, projection, look):
    env = make(ONE, projection=projection)
    figure = env._env_plot.fig
    frames = [look(figure)]
    for _ in range(3):
        drive(env, 5)
        frames.append(look(figure))
    assert all((one != other).any() for one, other in itertools.pairwise(frames))
    assert env._env_plot.ax.get_title() == "Simulation Time: 1.50s, Status: Running"
    assert (look(figure) == frames[-1]).all()


def test_a_figure_drawn_by_hand_is_the_saved_one(env):
    drive(env)
    kept = env.save_figure("a.png", bbox_inches=None)
    assert (np.asarray(Image.open(kept))[..., :3] == drawn(env._env_plot.fig)[..., :3]).all()
    env.robot.set_state([5, 5, 0])  # no step, no frame
    assert (drawn(env._env_plot.fig)[..., :3] != np.asarray(Image.open(kept))[..., :3]).any()


def test_what_a_script_draws_and_writes_stays(env):
    env._env_plot.ax.set_xlabel("east")
    before = drawn(env._env_plot.fig)
    env._env_plot.ax.set_xlabel("west")
    drawn(env._env_plot.fig)
    path = env.save_figure("b.png", bbox_inches=None)
    assert (np.asarray(Image.open(path))[..., :3] != before[..., :3]).any()


@pytest.mark.parametrize("display", [True, False])
def test_pyplot_finds_the_figure_from_the_start(make, display, tmp_path):
    env = make(ONE, display=display)
    assert len(plt.get_fignums()) == 1
    assert not env._env_plot.made  # costs nothing before it is used
    plt.plot([1, 2], [3, 4])
    assert plt.gcf() is env._env_plot.fig
    assert plt.gca() is env._env_plot.ax
    assert len(env._env_plot.ax.lines) == 1
    plt.savefig(tmp_path / "c.png")
    drive(env)
    plt.savefig(tmp_path / "d.png")
    assert (tmp_path / "c.png").read_bytes() != (tmp_path / "d.png").read_bytes()
    env.end(0)
    assert plt.get_fignums() == []


def test_the_figure_of_a_script_stays_the_current_one(env):
    own = plt.figure()
    env.render(0)
    assert env._env_plot.fig is not own
    assert plt.gcf() is own
    plt.close(env._env_plot.fig)
    assert plt.get_fignums() == [own.number]
    drive(env)


def test_an_environment_that_is_gone_leaves_no_figure(make):
    env = make(ONE)
    env.render(0)
    _ = env._env_plot.fig
    del env
    gc.collect(1)  # what is young
    assert plt.get_fignums() == []


def test_headless_environments_are_not_listed(make):
    env = make(ONE, headless=True)
    assert plt.get_fignums() == []
    env.end()


# without a screen
SCREENLESS = [{"DISPLAY": ":4711", "MPLBACKEND": "Agg"}]
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
again = irsim.make(env.scenario, display=False)
again._env_plot.fig
assert "matplotlib.pyplot" not in sys.modules
assert "tkinter" not in sys.modules
import matplotlib.pyplot as plt
assert plt.gcf() is again._env_plot.fig
other = irsim.make(env.scenario, display=False)
plt.close("all")
late = irsim.make(env.scenario, display=False)
"""


@pytest.mark.parametrize("display", ["True", pytest.param("False", marks=pytest.mark.slow)])
@pytest.mark.parametrize("variables", SCREENLESS)
def test_without_a_screen_there_are_files_and_pyplot_finds_the_figure_later(tmp_path, display, variables):
    (tmp_path / "world.yaml").write_text(ONE)
    kept = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY", "MPLBACKEND")}
    command = [sys.executable, "-c", SCRIPT % display]
    done = subprocess.run(command, cwd=tmp_path, env={**kept, **variables}, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "figure" / "last.png").stat().st_size > 5000
    assert (tmp_path / "animation" / "animation_world.gif").stat().st_size > 3000


class FakeWindow:
    """The parts of a window that the picture needs."""

    def __init__(self, size, dpi, **_):
        self.figure = Figure(figsize=(size[0] / dpi, size[1] / dpi), dpi=dpi)
        self.canvas = FigureCanvasAgg(self.figure)
        self.open, self.shown = True, []

    def refresh(self, seconds):
        self.shown.append((seconds, read(self.figure)))

    def close(self):
        self.open = False


def test_a_window_shows_each_frame(make, monkeypatch):
    opened = []

    def open_window(*args, **kwargs):
        opened.append(FakeWindow(*args, **kwargs))
        return opened[-1]

    monkeypatch.setattr(window, "open_window", open_window)
    monkeypatch.setattr(window, "has_screen", lambda: True)
    env = make(ONE, display=True)
    for _ in range(3):
        env.step()
        env.render(0.25)
    (shown,) = opened
    assert [seconds for seconds, _ in shown.shown] == [0.25] * 3
    assert (shown.shown[0][1] != shown.shown[2][1]).any()
    shown.open = False
    drive(env)
    assert len(shown.shown) == 3
    env.end(ending_time=0)
    assert not shown.open


@pytest.mark.parametrize(
    ("platform", "variables", "screen"),
    [
        ("linux", {}, False),
        ("linux", {"DISPLAY": ":0"}, True),
        ("linux", {"DISPLAY": ":0", "MPLBACKEND": "agg"}, False),
        ("darwin", {}, True),
    ],
)
def test_windows_need_a_screen(monkeypatch, platform, variables, screen):
    monkeypatch.setattr(sys, "platform", platform)
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "MPLBACKEND"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert window.has_screen() is screen


@pytest.mark.parametrize("display", [True, False])
def test_without_a_window_nothing_is_drawn_before_someone_looks(make, monkeypatch, display):
    monkeypatch.setattr(window, "has_screen", lambda: False)
    env = make(ONE, display=display)
    drive(env, 3)
    assert not env._env_plot.made
    assert read(env._env_plot.fig).min() == 0
