"""The ``gui`` section."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from irsim.options.base import Options
from irsim.options.units import Bool, Count, MetersPerSecond, Number, RadiansPerSecond
from irsim.options.vectors import OrNull

__all__ = ["Gui", "Keyboard", "Mouse"]


class Keyboard(Options):
    """Keyboard control of one robot; on with `world.control_mode: keyboard` or after pressing the key `x`."""

    backend: Literal["pynput", "mpl"] = "pynput"
    """Where key presses come from: a global listener (package pynput) or the figure window."""
    global_hook: Bool = False
    """With `pynput`: react even when the window is not in front."""
    key_lv_max: Annotated[MetersPerSecond, Field(ge=0)] = 3.0
    """Linear speed while a key is held."""
    key_ang_max: Annotated[RadiansPerSecond, Field(ge=0)] = 1.0
    """Angular speed while a key is held."""
    key_lv: MetersPerSecond = 0.0
    """Initial linear speed."""
    key_ang: RadiansPerSecond = 0.0
    """Initial angular speed."""
    key_rot: RadiansPerSecond = 0.0
    """Initial yaw rate (`omni_angular`)."""
    key_id: Count = 0
    """Index of the robot that the keyboard drives."""


class Mouse(Options):
    """Mouse control of the view."""

    zoom_factor: Annotated[Number, Field(gt=0)] = 1.1
    """Zoom ratio per step of the scroll wheel."""


class Gui(Options):
    """Keyboard and mouse."""

    keyboard: Annotated[Keyboard, OrNull({})] = Keyboard()
    """Keyboard control of a robot."""
    mouse: Annotated[Mouse, OrNull({})] = Mouse()
    """Mouse control of the view."""
