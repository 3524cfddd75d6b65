"""The browser page of a simulation: ``irsim run --watch`` serves it to this machine and feeds it while it simulates."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.common.lazy import lazy_names

if TYPE_CHECKING:
    from irsim.studio.window import Window

__all__ = ["Window"]

__getattr__, __dir__ = lazy_names(__name__, {"Window": "irsim.studio.window"})
