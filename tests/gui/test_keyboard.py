"""Keys, sent as real events to a figure's canvas."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.backend_bases import KeyEvent

import irsim
from tests.env.driving import take_steps

YAML = """\
world: {{control_mode: {mode}, width: 10, height: 8}}
robot:
  - {{kinematics: {{name: {drive}}}, shape: {{name: circle, radius: 0.2}}, state: [2, 2, 0], goal: [9, 7],
     vel_max: {limits}, vel_min: {lower}, behavior: {{name: dash}}}}
  - {{kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.2}}, state: [2, 6, 0], goal: [9, 6], name: second}}
gui: {{keyboard: {{backend: mpl, key_lv_max: 2.0, key_ang_max: 0.5}}}}
"""


def opened(tmp_path: Path, mode: str = "keyboard", drive: str = "diff") -> irsim.Env:
    limits = [5.0] * (3 if drive == "omni_angular" else 2)
    path = tmp_path / "keys.yaml"
    text = YAML.format(mode=mode, drive=drive, limits=limits, lower=[-v for v in limits])
    path.write_text(text, encoding="utf-8")
    env = irsim.make(str(path), display=False, log_level="ERROR")
    _ = env._env_plot.ax
    return env


@pytest.fixture
def env(tmp_path: Path) -> Iterator[irsim.Env]:
    made = opened(tmp_path)
    yield made
    made.end(ending_time=0)


def press(env: irsim.Env, key: str) -> None:
    send(env, "key_press_event", key)


def release(env: irsim.Env, key: str) -> None:
    send(env, "key_release_event", key)


def send(env: irsim.Env, name: str, key: str) -> None:
    canvas: Any = env._env_plot.fig.canvas
    canvas.callbacks.process(name, KeyEvent(name, canvas, key))


def test_held_keys_drive_the_robot(env: irsim.Env) -> None:
    press(env, "w")
    press(env, "a")
    env.step()
    assert (env.robot.velocity[:, 0].tolist(), env.key_vel[:, 0].tolist()) == ([2.0, 0.5], [2.0, 0.5, 0.0])
    release(env, "a")
    env.step()
    assert env.robot.velocity[:, 0].tolist() == [2.0, 0.0]
    press(env, "s")
    assert env.key_vel[0, 0] == 0.0  # both held
    release(env, "w")
    assert (env.key_vel[0, 0], env.status) == (-2.0, "Running (keyboard)")


@pytest.mark.parametrize(
    ("drive", "expected"), [("omni", [0.0, 2.0]), ("omni_angular", [0.0, 2.0, -0.5]), ("acker", [0.0, 0.5])]
)
def test_the_turn_keys_suit_the_drive(tmp_path: Path, drive: str, expected: list[float]) -> None:
    """Sideways is scaled by the ratio of the top speeds, as in the reference."""
    env = opened(tmp_path, drive=drive)
    press(env, "a")
    press(env, "e")
    env.step()
    assert env.robot.velocity[:, 0].tolist() == expected
    env.end(ending_time=0)


def test_keys_win_over_actions_and_behaviors_of_their_robot_only(env: irsim.Env) -> None:
    env.step([[1.0, 0.0], [0.7, 0.0]])
    assert (env.robot.velocity[0, 0], env.robot_list[1].velocity[0, 0]) == (0.0, 0.7)


def test_choosing_another_robot(env: irsim.Env) -> None:
    press(env, "alt+1")
    press(env, "w")
    env.step()
    assert env.key_id == 1
    assert env.robot_list[1].velocity[0, 0] == 1.0  # its limit
    press(env, "alt+7")
    env.step()  # there is no such robot: no effect


def test_top_speeds(env: irsim.Env) -> None:
    for key in ("c", "Z", "shift+z"):
        press(env, key)
    assert env.keyboard is not None
    assert (env.keyboard.key_ang_max, env.keyboard.key_lv_max) == (pytest.approx(0.7), pytest.approx(1.6))
    for _ in range(20):
        press(env, "Z")
    assert env.keyboard.key_lv_max == 0.0


def test_x_switches_between_keys_and_behaviors(env: irsim.Env) -> None:
    press(env, "x")
    env.step()
    assert env.robot.velocity[0, 0] > 0
    press(env, "x")
    env.step()
    assert env.robot.velocity[0, 0] == 0.0


def test_space_pauses_and_goes_on(env: irsim.Env) -> None:
    press(env, " ")
    env.step()
    assert (env.time, env.status) == (0.0, "Pause")
    press(env, " ")
    env.step()
    assert env.time == 0.1


def test_f5_goes_step_by_step(env: irsim.Env) -> None:
    env.step()
    press(env, "f5")
    take_steps(env, 3)
    assert (env.time, env.status) == (0.2, "Pause (Debugging)")
    press(env, " ")
    press(env, " ")
    env.step()
    assert env.time == 0.3


def test_reset_reload_and_save_happen_with_the_next_frame(
    env: irsim.Env, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    env.path_param.fig_path = str(tmp_path / "figure")
    env.step()
    press(env, "v")
    press(env, "r")
    assert env.time == 0.1
    env.render(0)
    assert env.time == 0.0
    assert [path.name for path in (tmp_path / "figure").iterdir()] == ["keys_0001.png"]
    env.step()
    press(env, "l")
    env.render(0)
    assert env.time == 0.0
    press(env, "w")  # keys act on after a reload
    env.step()
    assert env.robot.velocity[0, 0] == 2.0


def test_escape_ends_the_program(env: irsim.Env) -> None:
    press(env, "escape")
    with pytest.raises(SystemExit):
        env.step()


def test_two_environments_have_keys_of_their_own(tmp_path: Path) -> None:
    one, two = opened(tmp_path), opened(tmp_path)
    press(one, "w")
    one.step()
    two.step()
    assert one.robot.velocity[0, 0] == 2.0
    assert two.robot.velocity[0, 0] == 0.0
    one.end(ending_time=0)
    press(two, "w")
    two.step()
    assert two.robot.velocity[0, 0] == 2.0
    two.end(ending_time=0)


def test_headless_has_no_keyboard(tmp_path: Path) -> None:
    opened(tmp_path).end(ending_time=0)
    env = irsim.make(str(tmp_path / "keys.yaml"), headless=True, log_level="ERROR")
    assert (env.keyboard, env.mouse) == (None, None)
    assert np.array_equal(env.key_vel, np.zeros((3, 1)))
    env.step()
    env.render()
    env.end()


def test_without_pynput_the_figure_is_listened_to(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pynput", None)
    path = tmp_path / "keys.yaml"
    path.write_text("world: {control_mode: keyboard}\nrobot: {kinematics: {name: diff}, state: [1, 1, 0]}\n")
    env = irsim.make(str(path), log_level="ERROR")
    _ = env._env_plot.ax
    press(env, "w")
    env.step()
    assert env.keyboard is not None
    assert (env.keyboard.backend, env.robot.velocity[0, 0]) == ("mpl", 1.0)
    env.end(ending_time=0)
