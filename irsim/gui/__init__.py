"""Live control: keyboard and mouse."""

from irsim.gui.keyboard import KeyboardControl
from irsim.gui.mouse import MouseControl

__all__ = ["KeyboardControl", "MouseControl"]
