"""Keyboard control: keys drive a robot and pause, step or end a run.

Key events come from the window of the figure or from a global listener (package ``pynput``).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from irsim.common.log import Logger

__all__ = ["KEY_TABLE", "KeyboardControl"]

_TOP_SPEED_STEP = 0.2
"""Change of the top speed [m/s] or top turn rate [rad/s] per key press."""
_AXES = {
    "w": ("linear", 1),
    "s": ("linear", -1),
    "a": ("turn", 1),
    "d": ("turn", -1),
    "q": ("yaw", 1),
    "e": ("yaw", -1),
}
"""Key -> (axis of the command, sign)."""
_FLAGS = {"r": "reset_flag", "l": "reload_flag", "v": "save_figure_flag", "escape": "quit_flag"}
"""Key -> flag of the environment, which acts on it with the next frame or step."""
KEY_TABLE = (
    ("w / s", "forwards / backwards"),
    ("a / d", "turn left / right; sideways for omni drives"),
    ("q / e", "yaw left / right (omni_angular)"),
    ("z / c", "lower / raise the top turn rate"),
    ("shift + z / c", "lower / raise the top speed"),
    ("alt + digit", "drive another robot"),
    ("r", "reset"),
    ("l", "reload the file"),
    ("space", "pause or resume"),
    ("F5", "run a single step"),
    ("x", "switch between keyboard and behaviors"),
    ("v", "save the figure"),
    ("y", "stop or resume refreshing the window"),
    ("esc", "quit"),
)
"""Keys and what they do."""


class HasControlMode(Protocol):
    """The world parameter that keys read and switch."""

    control_mode: str


class Controlled(Protocol):
    """The target of the keys: the part of an environment that the keyboard needs."""

    logger: Logger
    display: bool
    pause_flag: bool
    quit_flag: bool
    debug_flag: bool
    debug_count: int
    reset_flag: bool
    reload_flag: bool
    save_figure_flag: bool

    @property
    def world_param(self) -> HasControlMode:
        """World parameters."""

    def pause(self) -> None:
        """Pause the run."""

    def resume(self) -> None:
        """Resume the run."""


class KeyboardControl:
    """Keyboard control of one environment.

    Args:
        env_ref: The environment. Without one, the control listens to the current figure of pyplot, and the keys set
            the command and nothing else.
        backend: ``mpl`` uses the key events of the figure. ``pynput`` listens globally; without that package or
            without a screen it falls back to ``mpl`` with a warning.
        global_hook: With ``pynput``, react even while the mouse is outside the figure.
        key_lv_max: Linear speed while a key is held [m/s].
        key_ang_max: Turn rate while a key is held [rad/s].
        key_lv, key_ang, key_rot: Initial linear, turn and yaw command.
        key_id: Index of the robot that the keys drive.

    Attributes:
        key_vel: (3, 1) linear, turn (or lateral) and yaw command.
        listener: The global listener, or None.
    """

    def __init__(
        self,
        env_ref: Controlled | None = None,
        *,
        backend: str = "pynput",
        global_hook: bool = False,
        key_lv_max: float = 3.0,
        key_ang_max: float = 1.0,
        key_lv: float = 0.0,
        key_ang: float = 0.0,
        key_rot: float = 0.0,
        key_id: int = 0,
    ) -> None:
        self.env_ref = env_ref
        self.backend, self.global_hook = backend, global_hook
        self.key_lv_max, self.key_ang_max = float(key_lv_max), float(key_ang_max)
        self.key_lv, self.key_ang, self.key_rot = float(key_lv), float(key_ang), float(key_rot)
        self.key_id = key_id
        self.key_vel: NDArray[np.float64] = np.array([[self.key_lv], [self.key_ang], [self.key_rot]])
        self.listener: Any = None
        self.in_figure = False
        self._held: set[str] = set()
        self._connections: list[tuple[Any, int]] = []
        self._own_logger: Logger | None = None
        if self._drives():
            for keys, what in KEY_TABLE:
                self.logger.info(f"{keys:<14} {what}")
        if env_ref is None:
            import matplotlib.pyplot as plt

            self.attach(plt.gcf().canvas)

    # sources of key events --------------------------------------------------------------------------------------------
    def attach(self, canvas: Any) -> None:
        """Connect to the key events of a figure; with the backend ``pynput``, start the global listener."""
        manager = getattr(canvas, "manager", None)
        handler = getattr(manager, "key_press_handler_id", None)
        if handler is not None:  # Matplotlib's own shortcuts would interfere: s saves, q closes, …
            canvas.mpl_disconnect(handler)
        if self.backend == "pynput" and not self._listen():
            self.backend = "mpl"
        events: dict[str, Callable[[Any], None]] = {
            "figure_enter_event": self._enter,
            "figure_leave_event": self._leave,
        }
        if self.backend == "mpl":
            events |= {"key_press_event": self._on_press, "key_release_event": self._on_release}
        self._connections = [(canvas, canvas.mpl_connect(name, call)) for name, call in events.items()]

    def _listen(self) -> bool:
        """Start the global listener, if possible, and return whether it runs."""
        if self.env_ref is not None and not self.env_ref.display:
            return False
        try:
            from pynput import keyboard
        except Exception as error:  # without a screen, pynput raises errors of several types
            reason = "not installed" if isinstance(error, ImportError) else str(error)
            if self.env_ref is None or self._drives():
                self.logger.warning(
                    f"keyboard backend pynput is unavailable ({reason}); using the key events of the figure"
                )
            return False
        self.listener = keyboard.Listener(
            on_press=lambda key: self._forward(key, self.press), on_release=lambda key: self._forward(key, self.release)
        )
        self.listener.start()
        return True

    def _forward(self, key: Any, handler: Callable[[str], None]) -> None:
        name = _matplotlib_name(key)
        if name is not None and (self.global_hook or self.in_figure):
            handler(name)

    def _enter(self, _: Any) -> None:
        self.in_figure = True

    def _leave(self, _: Any) -> None:
        self.in_figure = False

    def _on_press(self, event: Any) -> None:
        if event.key is not None:
            self.press(event.key)

    def _on_release(self, event: Any) -> None:
        if event.key is not None:
            self.release(event.key)

    def stop(self) -> None:
        """Disconnect from the figure and stop the listener."""
        for canvas, number in self._connections:
            canvas.mpl_disconnect(number)
        self._connections = []
        if self.listener is not None:
            self.listener.stop()
            self.listener = None

    close = stop

    @property
    def logger(self) -> Logger:
        """The logger of the environment, or one of its own."""
        if self.env_ref is not None:
            return self.env_ref.logger
        if self._own_logger is None:
            self._own_logger = Logger()
        return self._own_logger

    def _drives(self) -> bool:
        """Return whether the keys drive a robot of the environment now."""
        return self.env_ref is not None and self.env_ref.world_param.control_mode == "keyboard"

    # effects of keys ------------------------------------------------------------------------------------------------
    def press(self, key: str) -> None:
        """Handle a key press; keys have Matplotlib's names: ``w``, ``Z``, ``alt+1``, ``f5``, ``escape``."""
        plain = _without_modifiers(key)
        if plain in _AXES:
            self._held.add(plain)
            self._update_command()
        elif key.startswith("alt+") and plain.isdigit():
            self.key_id = int(plain)
            self.logger.info(f"the keyboard drives robot {self.key_id}")
        elif plain in ("z", "c"):
            change = -_TOP_SPEED_STEP if plain == "z" else _TOP_SPEED_STEP
            self._change_top_speed(change, linear=key.startswith("shift+") or key.isupper())
        else:
            self._act_on_environment(plain)

    def release(self, key: str) -> None:
        """Handle a key release."""
        plain = _without_modifiers(key)
        if plain in self._held:
            self._held.discard(plain)
            self._update_command()

    def _update_command(self) -> None:
        """Recompute the command from the keys that are held."""
        sums = {"linear": 0, "turn": 0, "yaw": 0}
        for key in self._held:
            axis, sign = _AXES[key]
            sums[axis] += sign
        self.key_lv = sums["linear"] * self.key_lv_max
        self.key_ang = sums["turn"] * self.key_ang_max
        self.key_rot = sums["yaw"] * self.key_ang_max
        self.key_vel = np.array([[self.key_lv], [self.key_ang], [self.key_rot]])

    def _change_top_speed(self, change: float, *, linear: bool) -> None:
        if linear:
            self.key_lv_max = max(0.0, self.key_lv_max + change)
        else:
            self.key_ang_max = max(0.0, self.key_ang_max + change)
        self.logger.info(f"top speed {self.key_lv_max:.1f} m/s, turn rate {self.key_ang_max:.1f} rad/s")
        self._update_command()

    def _act_on_environment(self, key: str) -> None:
        """Set the flag or change the setting of the environment that a key stands for."""
        env = self.env_ref
        if env is None:
            return
        if key in _FLAGS:
            setattr(env, _FLAGS[key], True)
        elif key == " ":
            if env.pause_flag:
                env.resume()
            else:
                env.pause()
        elif key == "f5":
            env.pause_flag, env.debug_flag = False, True
            env.debug_count += 1
        elif key == "x":
            world = env.world_param
            world.control_mode = "auto" if world.control_mode == "keyboard" else "keyboard"
            env.logger.info(f"control mode: {world.control_mode}")
        elif key == "y":
            env.display = not env.display

    def control(self, drive: str | None, size: int) -> NDArray[np.float64]:
        """Convert the present command to the controls of a drive.

        Args:
            drive: Name of the kinematics. For omni drives the turn command is a lateral speed: it is scaled by the
                ratio of the top speeds.
            size: Number of controls of the drive.

        Returns:
            (size,) controls.
        """
        linear, turn, yaw = self.key_vel[:, 0]
        if drive in ("omni", "omni_angular"):
            turn = turn * self.key_lv_max / self.key_ang_max if self.key_ang_max > 0 else 0.0
        command = np.zeros(size)
        values = np.array([linear, turn, yaw])[:size]
        command[: len(values)] = values
        return command


def _without_modifiers(key: str) -> str:
    """Return the bare key: ``w`` for ``shift+W``."""
    return key.rpartition("+")[2].lower() if key != "+" else key


def _matplotlib_name(key: Any) -> str | None:
    """Return Matplotlib's name of a ``pynput`` key, or None for a key without a name."""
    character = getattr(key, "char", None)
    if character:
        return str(character)
    name = getattr(key, "name", None)
    return {"space": " ", "esc": "escape"}.get(name, name) if name else None
