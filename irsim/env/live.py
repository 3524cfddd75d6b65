"""Live control of an environment: keyboard, mouse, and the requests that keys make."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irsim.env.queries import robot_list
from irsim.env.state import EnvState

if TYPE_CHECKING:
    from irsim.gui import KeyboardControl


def start_live(env: Any) -> None:
    """Start to listen to the keyboard, except in headless mode."""
    env._mouse = None
    env._keyboard = None
    if not env.headless:
        from irsim.gui.keyboard_control import KeyboardControl

        settings = env.scenario.gui.keyboard
        options = {name: getattr(settings, name) for name in type(settings).model_fields}
        env._keyboard = KeyboardControl(env, **options)


def attach_live(env: EnvState, ax: Any) -> None:
    """Start to listen to the mouse and the keyboard of a new figure."""
    from irsim.gui.mouse_control import MouseControl

    env._mouse = MouseControl(ax, env.scenario.gui.mouse.zoom_factor)
    if env._keyboard is not None:
        env._keyboard.attach(ax.figure.canvas)


def detach_live(env: EnvState) -> None:
    """Stop listening to keyboard and mouse."""
    for control in (env._mouse, env._keyboard):
        if control is not None:
            control.stop()
    env._mouse = None


def keyboard(env: EnvState) -> KeyboardControl | None:
    """Return the keyboard control; None in headless mode."""
    return env._keyboard


def key_vel(env: EnvState) -> NDArray[np.float64]:
    """Return the command of the keyboard, (3, 1): forward speed [m/s], turn or lateral command, yaw rate [rad/s]."""
    return np.zeros((3, 1)) if env._keyboard is None else env._keyboard.key_vel.copy()


def key_id(env: EnvState) -> int:
    """Return the index, among the robots, of the robot that the keyboard drives."""
    return env.scenario.gui.keyboard.key_id if env._keyboard is None else env._keyboard.key_id


def mouse_pos(env: EnvState) -> tuple[float, float] | None:
    """Return the position (x, y) of the mouse in the world [m]; None outside the axes."""
    return None if env._mouse is None else env._mouse.mouse_pos


def mouse_left_pos(env: EnvState) -> NDArray[np.float64] | None:
    """Return the position (2,) at which the left mouse button is held down [m]; None otherwise."""
    return None if env._mouse is None else env._mouse.left_click_pos


def mouse_right_pos(env: EnvState) -> NDArray[np.float64] | None:
    """Return the position (2,) at which the right mouse button is held down [m]; None otherwise."""
    return None if env._mouse is None else env._mouse.right_click_pos


def drive_by_keyboard(env: EnvState) -> None:
    """Give the command of the keyboard to the robot it drives, in place of any other action."""
    robots = robot_list(env)
    if env._keyboard is None or not 0 <= env._keyboard.key_id < len(robots):
        return
    robot, simulation = robots[env._keyboard.key_id], env._simulation
    simulation.impose(robot.row, env._keyboard.control(robot.kinematics, robot.vel_dim))


def carry_out_requests(env: Any) -> None:
    """Carry out what keys have requested since the last frame."""
    if env.save_figure_flag:
        env.save_figure_flag = False
        env.save_figure(include_index=True)
    if env.reset_flag:
        env.reset_flag = False
        env.reset()
    if env.reload_flag:
        env.reload_flag = False
        env.reload()
