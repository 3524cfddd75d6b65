"""Control of a running environment: keyboard and mouse."""

from irsim.gui.keyboard_control import KeyboardControl
from irsim.gui.mouse_control import MouseControl

__all__ = ["KeyboardControl", "MouseControl"]
