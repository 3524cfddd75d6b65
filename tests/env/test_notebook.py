"""Environments, batches and policies in a notebook, and the replay of an environment's episode."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import irsim
from irsim.common.installed import script_folder
from irsim.diagnostics.errors import InputError
from irsim.rendering import env_plot
from irsim.runs.replay.inline import replay_of_env
from tests.env.driving import Make, take_steps

NAME = "<b>rob & co</b>"
TEXT = f"""
world: {{width: 10, height: 10, step_time: 0.1}}
robot: {{name: "{NAME}", state: [1, 5, 0], goal: [9, 5], kinematics: {{name: diff}}, behavior: {{name: dash}},
        sensors: [{{name: lidar2d, number: 20}}]}}
obstacle: {{state: [5, 8], shape: {{name: circle, radius: 0.5}}}}
"""
ESCAPED = "&lt;b&gt;rob &amp; co&lt;/b&gt;"


def test_names_of_files_are_escaped(make: Make, tmp_path: Path) -> None:
    env = make(TEXT)
    (tmp_path / "scene.yaml").write_text(TEXT, encoding="utf-8")
    result = irsim.run(tmp_path / "scene.yaml", steps=3)
    for shown in (env._repr_html_(), result._repr_html_()):
        assert ESCAPED in shown
        assert NAME not in shown


def test_an_environment_shows_the_present_state(make: Make) -> None:
    env = make(TEXT)
    before = env._repr_html_()
    take_steps(env, 20)
    after = env._repr_html_()
    assert "<td" in after
    assert "2 s" in after
    assert before.count("data:image/png;base64,") == after.count("data:image/png;base64,") == 1
    assert before != after


def test_a_cell_shows_each_frame_for_the_interval(make: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    happened: list[str | float] = []

    class Below:
        """The place below a cell."""

        def show(self, png: bytes) -> None:
            happened.append(png[1:4].decode())

    monkeypatch.setattr(env_plot, "draws_inline", lambda: True)
    monkeypatch.setattr(env_plot, "Cell", Below)
    monkeypatch.setattr(time, "sleep", happened.append)
    env = make(TEXT, display=True, headless=False)
    for _ in range(2):
        env.step()
        env.render(0.25)
    assert happened == ["PNG", 0.25, "PNG", 0.25]
    env.end(ending_time=30)
    assert 30 not in happened  # the picture stays without waiting


def test_a_batch_and_a_policy_show_themselves(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(TEXT, encoding="utf-8")
    worlds = irsim.batch(tmp_path / "scene.yaml", 12, seeds=range(12))
    worlds.step()
    assert "and 2 more rows" in worlds._repr_html_()
    assert "Policy orca" in irsim.open_policy("orca")._repr_html_()


def test_the_replay_of_a_loop_has_what_happened(make: Make) -> None:
    env = make(TEXT)
    for _ in range(30):
        env.step([0.5, 0.3])
    pose = env.robot.state[:, 0].copy()
    replay = env.replay()
    assert replay._repr_html_().startswith("<iframe ")
    assert "30 steps" in repr(replay)
    np.testing.assert_array_equal(env.robot.state[:, 0], pose)  # nothing has moved
    env.reset(random=True)
    env.step()
    assert "1 steps" in repr(env.replay())


def test_the_replay_is_a_file_too(make: Make, tmp_path: Path) -> None:
    env = make(TEXT)
    take_steps(env, 3)
    page = env.replay().save(tmp_path / "page.html").read_text(encoding="utf-8")
    assert page.startswith("<!doctype html>")
    assert page == env.replay().text


def test_a_past_that_is_not_known_is_one_error(make: Make) -> None:
    env = make(TEXT)
    env.step()
    env.delete_object(1)
    with pytest.raises(InputError, match="added or deleted"):
        replay_of_env(env)


def test_pictures_go_beside_the_script_or_into_the_working_directory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script = ModuleType("__main__")
    monkeypatch.setitem(sys.modules, "__main__", script)
    monkeypatch.setattr(sys, "path", ["/usr/lib/python311.zip", *sys.path])
    assert script_folder() is None  # a notebook
    script.__file__ = str(tmp_path / "script.py")
    assert script_folder() == str(tmp_path)
    monkeypatch.setattr(sys, "path", ["/somewhere", *sys.path])
    assert script_folder() == "/somewhere"
    script.__file__ = str(Path(sys.executable).with_name("pytest"))
    monkeypatch.setattr(sys, "path", [str(Path(sys.executable).parent), *sys.path])
    assert script_folder() is None  # an installed program
