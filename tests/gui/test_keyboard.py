"""Keys, sent as real events to a figure's canvas."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.backend_bases import KeyEvent

from tests.env.driving import Make, take_steps

YAML = """\
world: {{control_mode: keyboard, width: 10, height: 8}}
robot:
  - {{kinematics: {{name: {drive}}}, shape: {{name: circle, radius: 0.2}}, state: [2, 2, 0], goal: [9, 7],
     vel_max: {limits}, vel_min: {lower}, behavior: {{name: dash}}}}
  - {{kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.2}}, state: [2, 6, 0], goal: [9, 6], name: second}}
gui: {{keyboard: {{backend: mpl, key_lv_max: 2.0, key_ang_max: 0.5}}}}
"""


def keys_of(drive: str = "diff") -> str:
    limits = [5.0] * (3 if drive == "omni_angular" else 2)
    return YAML.format(drive=drive, limits=limits, lower=[-v for v in limits])


@pytest.fixture
def env(make: Make) -> Any:
    return opened(make)


def opened(make: Make, text: str = keys_of()) -> Any:
    env = make(text, headless=False, display=False)
    _ = env._env_plot.ax
    return env


def press(env: Any, *keys: str) -> None:
    for key in keys:
        send(env, "key_press_event", key)


def send(env: Any, name: str, key: str) -> None:
    canvas = env._env_plot.fig.canvas
    canvas.callbacks.process(name, KeyEvent(name, canvas, key))


def test_held_keys_drive_the_robot(env: Any) -> None:
    press(env, "w", "a")
    env.step()
    assert (env.robot.velocity[:, 0].tolist(), env.key_vel[:, 0].tolist()) == ([2.0, 0.5], [2.0, 0.5, 0.0])
    send(env, "key_release_event", "a")
    env.step()
    assert env.robot.velocity[:, 0].tolist() == [2.0, 0.0]
    press(env, "s")
    assert env.key_vel[0, 0] == 0.0  # both held
    send(env, "key_release_event", "w")
    assert (env.key_vel[0, 0], env.status) == (-2.0, "Running (keyboard)")


@pytest.mark.parametrize(
    ("drive", "expected"), [("omni", [0.0, 2.0]), ("omni_angular", [0.0, 2.0, -0.5]), ("acker", [0.0, 0.5])]
)
def test_the_turn_keys_suit_the_drive(make: Make, drive: str, expected: list[float]) -> None:
    """Sideways is scaled by the ratio of the top speeds, as in the reference."""
    env = opened(make, keys_of(drive))
    press(env, "a", "e")
    env.step()
    assert env.robot.velocity[:, 0].tolist() == expected


def test_keys_win_over_actions_and_behaviors_of_their_robot_only(env: Any) -> None:
    env.step([[1.0, 0.0], [0.7, 0.0]])
    assert [robot.velocity[0, 0] for robot in env.robot_list] == [0.0, 0.7]


def test_choosing_another_robot(env: Any) -> None:
    press(env, "alt+1", "w")
    env.step()
    assert (env.key_id, env.robot_list[1].velocity[0, 0]) == (1, 1.0)  # its limit
    press(env, "alt+7")
    env.step()  # there is no such robot: no effect


def test_top_speeds(env: Any) -> None:
    press(env, "c", "Z", "shift+z")
    assert (env.keyboard.key_ang_max, env.keyboard.key_lv_max) == pytest.approx((0.7, 1.6))
    press(env, *["Z"] * 20)
    assert env.keyboard.key_lv_max == 0.0


def test_x_switches_between_keys_and_behaviors(env: Any) -> None:
    for driven_by_behavior in (True, False):
        press(env, "x")
        env.step()
        assert (env.robot.velocity[0, 0] > 0) == driven_by_behavior


def test_space_pauses_and_f5_goes_step_by_step(env: Any) -> None:
    press(env, " ")
    env.step()
    assert (env.time, env.status) == (0.0, "Pause")
    press(env, " ")
    env.step()
    assert env.time == 0.1
    press(env, "f5")
    take_steps(env, 3)
    assert (env.time, env.status) == (0.2, "Pause (Debugging)")
    press(env, " ", " ")
    env.step()
    assert env.time == 0.3


def test_reset_reload_and_save_happen_with_the_next_frame(env: Any, tmp_path: Path) -> None:
    env.path_param.fig_path = str(tmp_path / "figure")
    env.step()
    press(env, "v", "r")
    assert env.time == 0.1
    env.render(0)
    assert env.time == 0.0
    assert [path.name for path in (tmp_path / "figure").iterdir()] == ["scenario_0001.png"]
    env.step()
    press(env, "l")
    env.render(0)
    assert env.time == 0.0
    press(env, "w")  # keys act on after a reload
    env.step()
    assert env.robot.velocity[0, 0] == 2.0


def test_escape_ends_the_program(env: Any) -> None:
    press(env, "escape")
    with pytest.raises(SystemExit):
        env.step()


def test_two_environments_have_keys_of_their_own(make: Make) -> None:
    one, two = opened(make), opened(make)
    press(one, "w")
    one.step()
    two.step()
    assert [env.robot.velocity[0, 0] for env in (one, two)] == [2.0, 0.0]
    one.end(ending_time=0)
    press(two, "w")
    two.step()
    assert two.robot.velocity[0, 0] == 2.0


def test_headless_has_no_keyboard(make: Make) -> None:
    env = make(keys_of())
    assert (env.keyboard, env.mouse) == (None, None)
    assert np.array_equal(env.key_vel, np.zeros((3, 1)))
    env.step()
    env.render()


def test_without_pynput_the_figure_is_listened_to(make: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pynput", None)
    text = "world: {control_mode: keyboard}\nrobot: {kinematics: {name: diff}, state: [1, 1, 0]}\n"
    env = make(text, headless=False)
    _ = env._env_plot.ax
    press(env, "w")
    env.step()
    assert (env.keyboard.backend, env.robot.velocity[0, 0]) == ("mpl", 1.0)
