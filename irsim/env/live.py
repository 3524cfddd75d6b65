"""The live side of an environment: keyboard, mouse, and what keys have asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irsim.env.drawing import EnvDrawing

if TYPE_CHECKING:
    from irsim.gui import KeyboardControl, MouseControl

__all__ = ["EnvLive"]


class EnvLive(EnvDrawing):
    """Keyboard and mouse of an environment; both act on its own figure only."""

    if TYPE_CHECKING:

        def reset(self, random: bool = False) -> None:
            """Back to the start."""

        def reload(self) -> None:
            """Read the scenario again."""

    def _start_live(self) -> None:
        self._mouse: MouseControl | None = None
        self._keyboard: KeyboardControl | None = None
        if not self.headless:
            from irsim.gui.keyboard_control import KeyboardControl

            settings = self.scenario.gui.keyboard
            options = {name: getattr(settings, name) for name in type(settings).model_fields}
            self._keyboard = KeyboardControl(self, **options)  # type: ignore[arg-type]  # an Env has all of these

    def _attach(self, ax: Any) -> None:
        """The figure was made: listen to it."""
        from irsim.gui.mouse_control import MouseControl

        self._mouse = MouseControl(ax, self.scenario.gui.mouse.zoom_factor)
        if self._keyboard is not None:
            self._keyboard.attach(ax.figure.canvas)

    def _redraw(self) -> None:
        super()._redraw()
        if self._mouse is not None:
            self._mouse.forget_zoom()

    def _detach(self) -> None:
        for control in (self._mouse, self._keyboard):
            if control is not None:
                control.stop()
        self._mouse = None

    @property
    def keyboard(self) -> KeyboardControl | None:
        """The keys; None in headless mode."""
        return self._keyboard

    @property
    def mouse(self) -> MouseControl | None:
        """The mouse over the figure (made if need be); None in headless mode."""
        if self._mouse is None and not self.headless:
            _ = self._env_plot.ax
        return self._mouse

    @property
    def key_vel(self) -> NDArray[np.float64]:
        """(3, 1) linear, turn (or lateral) and yaw command of the keyboard."""
        return np.zeros((3, 1)) if self._keyboard is None else self._keyboard.key_vel.copy()

    @property
    def key_id(self) -> int:
        """Index of the robot that the keyboard drives."""
        return self.scenario.gui.keyboard.key_id if self._keyboard is None else self._keyboard.key_id

    @property
    def mouse_pos(self) -> tuple[float, float] | None:
        """(x, y) under the mouse [m]; None outside the axes."""
        return None if self._mouse is None else self._mouse.mouse_pos

    @property
    def mouse_left_pos(self) -> NDArray[np.float64] | None:
        """(2,) where the left button is held down [m], else None."""
        return None if self._mouse is None else self._mouse.left_click_pos

    @property
    def mouse_right_pos(self) -> NDArray[np.float64] | None:
        """(2,) where the right button is held down [m], else None."""
        return None if self._mouse is None else self._mouse.right_click_pos

    def _drive_by_keyboard(self) -> None:
        """The command of the keyboard becomes that of its robot, over whatever else it was given."""
        robots = self.robot_list
        if self._keyboard is None or not 0 <= self._keyboard.key_id < len(robots):
            return
        robot, simulation = robots[self._keyboard.key_id], self._simulation
        simulation.impose(robot.row, self._keyboard.control(robot.kinematics, robot.vel_dim))

    def _carry_out(self) -> None:
        """What keys have asked for since the last frame."""
        if self.save_figure_flag:
            self.save_figure_flag = False
            self.save_figure(include_index=True)
        if self.reset_flag:
            self.reset_flag = False
            self.reset()
        if self.reload_flag:
            self.reload_flag = False
            self.reload()
