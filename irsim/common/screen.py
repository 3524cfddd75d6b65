"""Whether this machine has a screen, which no window library has to be loaded for."""

from __future__ import annotations

import os
import sys

__all__ = ["WINDOWLESS_BACKENDS", "has_screen"]

WINDOWLESS_BACKENDS = ("agg", "cairo", "pdf", "pgf", "ps", "svg", "template")
"""Backends of Matplotlib that only write files."""


def has_screen() -> bool:
    """Whether a window can appear: Linux needs an X or Wayland display, and MPLBACKEND can rule windows out."""
    if os.environ.get("MPLBACKEND", "").lower() in WINDOWLESS_BACKENDS:
        return False
    if sys.platform.startswith("linux"):
        return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    return True
