"""Options that all map generators have in common."""

from __future__ import annotations

from irsim.options.base import Options

__all__ = ["MapOptions"]


class MapOptions(Options):
    """Where the occupancy grid of the world comes from."""

    name: str
    """Name of the generator."""
