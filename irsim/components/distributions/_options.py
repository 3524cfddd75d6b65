"""Options that all distributions have in common."""

from __future__ import annotations

from typing import Protocol

from irsim.options.base import Options

__all__ = ["DistributionOptions", "WorldExtent"]


class DistributionOptions(Options):
    """How the objects of one entry are placed."""

    name: str
    """Name of the distribution."""


class WorldExtent(Protocol):
    """What a distribution may ask of the world: its size [m] and its middle."""

    @property
    def width(self) -> float:
        """Extent along x [m]."""

    @property
    def height(self) -> float:
        """Extent along y [m]."""

    @property
    def center(self) -> tuple[float, float]:
        """x, y of the middle [m]."""
