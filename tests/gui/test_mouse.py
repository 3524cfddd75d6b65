"""The mouse, sent as real events to a figure's canvas."""

from __future__ import annotations

from typing import Any

import pytest
from matplotlib.backend_bases import MouseEvent

import irsim
from irsim.gui import MouseControl
from tests.env.driving import Make


@pytest.fixture
def env(make: Make) -> Any:
    text = "world: {width: 10, height: 8}\ngui: {mouse: {zoom_factor: 2.0}}\n"
    return make(text, headless=False, display=False)


def send(env: Any, name: str, x: float, y: float, button: Any = None, step: int = 0) -> None:
    ax = env._env_plot.ax
    canvas = ax.figure.canvas
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


def test_zooming_keeps_the_point_under_the_pointer(env: Any) -> None:
    _ = env.mouse
    ax = env._env_plot.ax
    send(env, "scroll_event", 2.0, 4.0, button="up", step=1)
    for _ in range(2):
        assert (*ax.get_xlim(), *ax.get_ylim()) == pytest.approx((1.0, 6.0, 2.0, 6.0), abs=0.02)
        env.step()
        env.render(0)
    send(env, "scroll_event", 2.0, 4.0, button="down", step=-1)
    assert ax.get_xlim() == pytest.approx((0, 10), abs=0.02)
    send(env, "scroll_event", 2.0, 4.0, button="up", step=1)
    send(env, "button_press_event", 2.0, 4.0, button=2)
    assert (ax.get_xlim(), ax.get_ylim()) == ((0, 10), (0, 8))


def test_a_reset_shows_the_whole_world_again(env: Any) -> None:
    mouse = env.mouse
    send(env, "scroll_event", 2.0, 4.0, button="up", step=1)
    for reset in (env.reset, mouse.reset_zoom):
        reset()
        env.render(0)
        assert env._env_plot.ax.get_xlim() == (0.0, 10.0)


def test_zoom_factors_are_at_least_1_1(env: Any) -> None:
    mouse = MouseControl(env._env_plot.ax)
    mouse.set_zoom_factor(0.5)
    assert mouse.zoom_factor == 1.1
