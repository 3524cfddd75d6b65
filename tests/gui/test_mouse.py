"""The mouse, sent as real events to a figure's canvas."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from matplotlib.backend_bases import MouseEvent

import irsim
from irsim.gui import MouseControl


@pytest.fixture
def env(tmp_path: Path) -> Iterator[irsim.Env]:
    path = tmp_path / "mouse.yaml"
    path.write_text("world: {width: 10, height: 8}\ngui: {mouse: {zoom_factor: 2.0}}\n", encoding="utf-8")
    made = irsim.make(str(path), display=False, log_level="ERROR")
    yield made
    made.end(ending_time=0)


def send(env: irsim.Env, name: str, x: float, y: float, button: Any = None, step: int = 0) -> None:
    ax = env._env_plot.ax
    canvas: Any = ax.figure.canvas
    px, py = ax.transData.transform((x, y))
    canvas.callbacks.process(name, MouseEvent(name, canvas, px, py, button, step=step))


def test_position_and_buttons(env: irsim.Env) -> None:
    assert env.mouse_pos is None
    _ = env.mouse
    send(env, "motion_notify_event", 3.0, 4.0)
    assert env.mouse_pos == pytest.approx((3.0, 4.0), abs=0.02)
    send(env, "button_press_event", 2.0, 5.0, button=1)
    send(env, "button_press_event", 7.0, 1.0, button=3)
    assert env.mouse_left_pos == pytest.approx([2.0, 5.0], abs=0.02)
    assert env.mouse_right_pos == pytest.approx([7.0, 1.0], abs=0.02)
    send(env, "button_release_event", 2.0, 5.0, button=1)
    send(env, "button_release_event", 2.0, 5.0, button=3)
    assert (env.mouse_left_pos, env.mouse_right_pos) == (None, None)
    send(env, "motion_notify_event", -9.0, 4.0)
    assert env.mouse_pos is None


def test_zooming_keeps_the_point_under_the_pointer(env: irsim.Env) -> None:
    mouse = env.mouse
    assert mouse is not None
    ax = env._env_plot.ax
    before = ax.get_xlim(), ax.get_ylim()
    send(env, "scroll_event", 2.0, 4.0, button="up", step=1)
    assert ax.get_xlim() == pytest.approx((1.0, 6.0), abs=0.02)
    assert ax.get_ylim() == pytest.approx((2.0, 6.0), abs=0.02)
    env.step()
    env.render(0)
    assert ax.get_xlim() == pytest.approx((1.0, 6.0), abs=0.02)
    send(env, "scroll_event", 2.0, 4.0, button="down", step=-1)
    assert ax.get_xlim() == pytest.approx(before[0], abs=0.02)
    send(env, "scroll_event", 2.0, 4.0, button="up", step=1)
    send(env, "button_press_event", 2.0, 4.0, button=2)
    assert (ax.get_xlim(), ax.get_ylim()) == before


def test_a_reset_shows_the_whole_world_again(env: irsim.Env) -> None:
    assert env.mouse is not None
    send(env, "scroll_event", 2.0, 4.0, button="up", step=1)
    env.reset()
    env.render(0)
    assert env._env_plot.ax.get_xlim() == (0.0, 10.0)
    env.mouse.reset_zoom()
    assert env._env_plot.ax.get_xlim() == (0.0, 10.0)


def test_zoom_factors_are_at_least_1_1(env: irsim.Env) -> None:
    mouse = MouseControl(env._env_plot.ax)
    mouse.set_zoom_factor(0.5)
    assert mouse.zoom_factor == 1.1
