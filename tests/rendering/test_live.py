"""The figure shows the present however it is looked at, and pyplot knows it."""

import gc
import io
import itertools
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import irsim

pytestmark = pytest.mark.one_python

ONE = """
world: {height: 10, width: 10}
robot: {kinematics: {name: diff}, state: [1, 1, 0.78], goal: [9, 9, 0], shape: {name: circle, radius: 0.5},
  behavior: {name: dash}, plot: {show_trajectory: true}}
"""


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    path = tmp_path / "one.yaml"
    path.write_text(ONE)
    return path


@pytest.fixture(autouse=True)
def no_figures():
    plt = pytest.importorskip("matplotlib.pyplot")
    plt.close("all")
    plt.get_backend()  # chosen now: before Matplotlib 3.10 choosing one later would close the figures that are there
    yield
    plt.close("all")


def drawn(figure):
    figure.canvas.draw()
    return np.asarray(figure.canvas.buffer_rgba()).copy()


def read(figure):
    return np.asarray(figure.canvas.buffer_rgba()).copy()


def saved(figure):
    data = io.BytesIO()
    figure.savefig(data, format="png")
    return np.asarray(Image.open(data))


@pytest.mark.parametrize("projection", [None, "3d"])
@pytest.mark.parametrize("look", [drawn, read, saved])
def test_a_kept_figure_shows_every_frame(scenario, projection, look):
    env = irsim.make(scenario, projection=projection, display=False, seed=1)
    figure = env._env_plot.fig
    frames = [look(figure)]
    for _ in range(3):
        for _ in range(5):
            env.step()
            env.render(0)
        frames.append(look(figure))
    assert all((one != other).any() for one, other in itertools.pairwise(frames))
    assert env._env_plot.ax.get_title() == "Simulation Time: 1.50s, Status: Running"
    assert (look(figure) == frames[-1]).all()
    env.end(0)


def test_a_figure_drawn_by_hand_is_the_saved_one(scenario, tmp_path):
    env = irsim.make(scenario, display=False, seed=1)
    env.step()
    env.render(0)
    kept = env.save_figure(tmp_path / "a.png", bbox_inches=None)
    with Image.open(kept) as image:
        assert (np.asarray(image)[..., :3] == drawn(env._env_plot.fig)[..., :3]).all()
    env.robot.set_state([5, 5, 0])  # no step, no frame
    assert (drawn(env._env_plot.fig)[..., :3] != np.asarray(Image.open(kept))[..., :3]).any()
    env.end(0)


def test_what_a_script_draws_and_writes_stays(scenario, tmp_path):
    env = irsim.make(scenario, display=False, seed=1)
    env._env_plot.ax.set_xlabel("east")
    before = drawn(env._env_plot.fig)
    env._env_plot.ax.set_xlabel("west")
    drawn(env._env_plot.fig)
    env.save_figure(tmp_path / "b.png", bbox_inches=None)
    with Image.open(tmp_path / "b.png") as image:
        assert (np.asarray(image)[..., :3] != before[..., :3]).any()
    env.end(0)


@pytest.mark.parametrize("display", [True, False])
def test_pyplot_finds_the_figure_from_the_start(scenario, display, tmp_path):
    import matplotlib.pyplot as plt

    env = irsim.make(scenario, display=display, seed=1)
    assert len(plt.get_fignums()) == 1
    assert not env._env_plot.made  # costs nothing before it is used
    plt.plot([1, 2], [3, 4])
    assert plt.gcf() is env._env_plot.fig
    assert plt.gca() is env._env_plot.ax
    assert len(env._env_plot.ax.lines) == 1
    plt.savefig(tmp_path / "c.png")
    env.step()
    env.render(0)
    plt.savefig(tmp_path / "d.png")
    assert (tmp_path / "c.png").read_bytes() != (tmp_path / "d.png").read_bytes()
    env.end(0)
    assert plt.get_fignums() == []


def test_the_figure_of_a_script_stays_the_current_one(scenario):
    import matplotlib.pyplot as plt

    env = irsim.make(scenario, display=False)
    own = plt.figure()
    env.render(0)
    assert env._env_plot.fig is not own
    assert plt.gcf() is own
    plt.close(env._env_plot.fig)
    assert plt.get_fignums() == [own.number]
    env.step()
    env.render(0)
    env.end(0)


def test_an_environment_that_is_gone_leaves_no_figure(scenario):
    import matplotlib.pyplot as plt

    env = irsim.make(scenario, display=False)
    env.render(0)
    _ = env._env_plot.fig
    del env
    gc.collect()
    assert plt.get_fignums() == []


def test_headless_environments_are_not_listed(scenario):
    import matplotlib.pyplot as plt

    env = irsim.make(scenario, headless=True)
    assert plt.get_fignums() == []
    env.end()


def test_drawing_does_not_import_pyplot_but_is_found_by_it_later(scenario):
    code = (
        f"import sys, irsim; env = irsim.make({str(scenario)!r}, display=False); env.step()\n"
        "env.render(0); env._env_plot.fig; assert 'matplotlib.pyplot' not in sys.modules\n"
        "import matplotlib.pyplot as plt; assert plt.gcf() is env._env_plot.fig\n"
        "other = irsim.make(env.scenario, display=False); plt.close('all')\n"
        "late = irsim.make(env.scenario, display=False)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
